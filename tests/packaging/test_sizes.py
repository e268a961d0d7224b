"""The repository stays small: what git knows, less and with the weights, and each file of it."""

import io
import tarfile

import pytest

from tests.packaging.contents import REPOSITORY, tracked

if not (REPOSITORY / ".git").exists():
    pytest.skip("git knows nothing of an unpacked sdist", allow_module_level=True)

SIZES = {path: (REPOSITORY / path).stat().st_size for path in tracked()}
WEIGHTS = {path: size for path, size in SIZES.items() if path.endswith(".safetensors")}
LARGEST_FILE_BYTES, LARGEST_WEIGHTS_FILE_BYTES = 1_000_000, 5_000_000
ARCHIVE_BYTES = 12_000_000
"""Of what one downloads: `git archive HEAD | gzip | wc -c`."""
ALL_WEIGHTS_BYTES, ALL_OTHERS_BYTES = 9_000_000, 10_000_000


def test_no_file_is_large() -> None:
    large = {
        path: size
        for path, size in SIZES.items()
        if size >= (LARGEST_WEIGHTS_FILE_BYTES if path in WEIGHTS else LARGEST_FILE_BYTES)
    }
    assert large == {}


def test_all_files_together_are_not_large() -> None:
    weights = sum(WEIGHTS.values())
    assert weights < ALL_WEIGHTS_BYTES
    assert sum(SIZES.values()) - weights < ALL_OTHERS_BYTES


def test_the_packed_repository_is_not_large() -> None:
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w:gz", compresslevel=6) as archive:
        for path in sorted(SIZES):
            archive.add(REPOSITORY / path, arcname=path)
    assert packed.tell() < ARCHIVE_BYTES
