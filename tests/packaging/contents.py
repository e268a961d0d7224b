"""What the wheel and the sdist must hold: what git knows of them, no more and no less."""

import subprocess
import tarfile
import zipfile
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
LINKED = {"controllers", "graph_planner", "metrics", "models"}
"""Folders that stand below the package where it is installed."""
LARGEST_BYTES = 8_000_000
"""Of a wheel."""

OF_THE_HOUSE = {".ci", ".github", ".gitignore", ".pre-commit-config.yaml"}
"""First parts of paths that only a clone needs: an sdist leaves them out."""

OF_THE_SDIST = {"PKG-INFO"}
OF_THE_WHEEL = {"METADATA", "RECORD", "WHEEL", "entry_points.txt", "licenses/LICENSE"}
"""In its folder `.dist-info`."""


def tracked() -> set[str]:
    """Return the paths that git knows, and that are still there."""
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=REPOSITORY, capture_output=True, check=True, text=True
    ).stdout.split("\0")
    return {path for path in listed if path and (REPOSITORY / path).is_file()}


def installed(path: str) -> str:
    """Return where a file of the repository stands below the one package that is installed."""
    return f"mjforage/{path}" if path.split("/")[0] in LINKED else path


def wheel_paths(files: set[str]) -> set[str]:
    """Return where files of the repository stand in a wheel."""
    placed = {installed(path) for path in files}
    return {path for path in placed if path.startswith("mjforage/")}


def sdist_paths(files: set[str]) -> set[str]:
    """Return which files of the repository stand in an sdist."""
    kept = {path for path in files if path.split("/")[0] not in OF_THE_HOUSE}
    return {path if path.startswith("models/") else installed(path) for path in kept} | {
        ".gitignore"
    }


def differences(found: set[str], expected: set[str], what: str) -> list[str]:
    """Return a line for each file that is too much or missing."""
    extra = [f"{what}: {path} is in it, but git does not know it" for path in found - expected]
    return sorted(extra) + sorted(f"{what}: {path} is missing" for path in expected - found)


def wheel_faults(wheel: Path, files: set[str]) -> list[str]:
    """Return what is wrong with a wheel's contents and size, a line each."""
    with zipfile.ZipFile(wheel) as archive:
        found = set(archive.namelist())
    info = {path for path in found if ".dist-info/" in path}
    named = {path.partition(".dist-info/")[2] for path in info}
    size = wheel.stat().st_size
    large = f"{wheel.name}: {size:,} bytes, {LARGEST_BYTES:,} at most"
    return (
        differences(found - info, wheel_paths(files), wheel.name)
        + differences(named, OF_THE_WHEEL, f"{wheel.name}'s .dist-info")
        + ([large] if size > LARGEST_BYTES else [])
    )


def sdist_faults(sdist: Path, files: set[str]) -> list[str]:
    """Return what is wrong with an sdist's contents, a line each."""
    with tarfile.open(sdist) as archive:
        names = [member.name for member in archive.getmembers() if member.isfile()]
    found = {name.partition("/")[2] for name in names}
    return differences(found, sdist_paths(files) | OF_THE_SDIST, sdist.name)
