"""A wheel with too much, too little, or too large, and an sdist likewise."""

import io
import tarfile
import zipfile
from pathlib import Path

import pytest

from tests.packaging import contents
from tests.packaging.contents import OF_THE_WHEEL, sdist_faults, wheel_faults

FILES = {
    "mjforage/scenario/maps.py",
    "models/maps/a.csv",
    "tests/test_a.py",
    "docs/a.md",
    ".ci/run",
}
HELD = ("mjforage/scenario/maps.py", "mjforage/models/maps/a.csv")


def wheel_of(folder: Path, *names: str, size: int = 1) -> Path:
    """A wheel with files of random bytes, which do not compress."""
    path = folder / "some-0.1.0-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as archive:
        for name in (*names, *(f"some-0.1.0.dist-info/{name}" for name in OF_THE_WHEEL)):
            archive.writestr(name, b"x" * size)
    return path


def sdist_of(folder: Path, *names: str) -> Path:
    path = folder / "some-0.1.0.tar.gz"
    with tarfile.open(path, "w:gz") as archive:
        for name in names:
            archive.addfile(tarfile.TarInfo(f"some-0.1.0/{name}"), io.BytesIO())
    return path


def test_a_whole_wheel_has_no_fault(tmp_path: Path) -> None:
    assert wheel_faults(wheel_of(tmp_path, *HELD), FILES) == []


def test_a_wheel_with_tests_and_without_maps_is_named(tmp_path: Path) -> None:
    assert wheel_faults(wheel_of(tmp_path, HELD[0], "tests/test_a.py"), FILES) == [
        "some-0.1.0-py3-none-any.whl: tests/test_a.py is in it, but git does not know it",
        "some-0.1.0-py3-none-any.whl: mjforage/models/maps/a.csv is missing",
    ]


def test_a_large_wheel_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contents, "LARGEST_BYTES", 1_000)
    (fault,) = wheel_faults(wheel_of(tmp_path, *HELD, size=1_000), FILES)
    assert fault.endswith("bytes, 1,000 at most")


def test_an_sdist_has_what_builds_and_tests_it(tmp_path: Path) -> None:
    held = (FILES - {".ci/run"}) | {".gitignore", "PKG-INFO"}
    assert sdist_faults(sdist_of(tmp_path, *held), FILES) == []
    assert sdist_faults(sdist_of(tmp_path, *held - {"docs/a.md"}), FILES) == [
        "some-0.1.0.tar.gz: docs/a.md is missing"
    ]
