"""Contents of the wheel and the sdist: what git knows of them, no more and no less."""

import subprocess
import tarfile
import zipfile
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
LINKED = ("controllers/", "graph_planner/", "metrics/", "models/")
"""Folders that stand below the package where it is installed."""
LARGEST_WHEEL_BYTES = 8_000_000
ONLY_OF_A_CLONE = (".ci/", ".github/", ".pre-commit-config.yaml")
"""Paths that an sdist leaves out."""
OF_THE_WHEEL = {"METADATA", "RECORD", "WHEEL", "entry_points.txt", "licenses/LICENSE"}
"""In its folder `.dist-info`."""


def tracked() -> set[str]:
    """Return the paths that git knows, and that are still there."""
    asked = ["git", "ls-files", "-z"]
    listed = subprocess.run(asked, cwd=REPOSITORY, stdout=subprocess.PIPE, check=True, text=True)
    return {path for path in listed.stdout.split("\0") if (REPOSITORY / path).is_file()}


def installed(path: str) -> str:
    """Return where a file of the repository stands below the one package that is installed."""
    return f"mjforage/{path}" if path.startswith(LINKED) else path


def differences(found: set[str], expected: set[str], what: str) -> list[str]:
    """Return a line for each file that is too much or missing."""
    extra = [f"{what}: {path} is in it, but git does not know it" for path in found - expected]
    return sorted(extra) + sorted(f"{what}: {path} is missing" for path in expected - found)


def wheel_faults(wheel: Path) -> list[str]:
    """Return what is wrong with a wheel's contents and size, a line each."""
    with zipfile.ZipFile(wheel) as archive:
        found = set(archive.namelist())
    info = "-".join(wheel.name.split("-")[:2]) + ".dist-info"
    ours = {path for path in map(installed, tracked()) if path.startswith("mjforage/")}
    faults = differences(found, ours | {f"{info}/{name}" for name in OF_THE_WHEEL}, wheel.name)
    if (size := wheel.stat().st_size) > LARGEST_WHEEL_BYTES:
        faults.append(f"{wheel.name}: {size:,} bytes, {LARGEST_WHEEL_BYTES:,} at most")
    return faults


def sdist_faults(sdist: Path) -> list[str]:
    """Return what is wrong with an sdist's contents, a line each."""
    with tarfile.open(sdist) as archive:
        found = {one.name.partition("/")[2] for one in archive.getmembers() if one.isfile()}
    packed = {path for path in tracked() if not path.startswith(ONLY_OF_A_CLONE)}
    ours = {path if path.startswith("models/") else installed(path) for path in packed}
    return differences(found, ours | {"PKG-INFO"}, sdist.name)
