"""The code that decides a run's numbers: a hash of ours, and of each package of a user."""

import hashlib
import subprocess
import sys
import uuid
from collections.abc import Callable, Iterable
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, NamedTuple

from mjforage.base.registry import is_ours
from mjforage.scenario.assets import models_folder

DECISIVE = (
    *("base", "metrics", "controllers", "graph_planner"),
    *("scenario", "forcing", "mission", "physics", "runs/tables.py"),
)
"""Parts of our package that decide the numbers of a run; the rest draws, stores or prints."""
USUAL = ("numpy", "numba", "scipy")  # libraries that every run computes with
DIGITS = 8
_PACKAGE = Path(__file__).resolve().parents[1]
_SUFFIXES = (".py", ".so", ".pyd")


class Code(NamedTuple):
    """Fingerprint of the code that decides numbers, as in `run.json`."""

    hashes: dict[str, str]  # package or module -> hash of its files
    versions: dict[str, str]  # distribution -> version

    def joined(self, other: "Code") -> "Code":
        """Both, sorted."""
        both = ({**mine, **theirs} for mine, theirs in zip(self, other, strict=True))
        return Code(*(dict(sorted(one.items())) for one in both))


@lru_cache(maxsize=1)
def commit() -> str:
    """Commit of our source, with `-dirty` if files that it has were changed since.

    Empty where the source lies in no repository of its own, or git is missing.
    """
    root = _PACKAGE.parent
    if not (root / ".git").exists():
        return ""
    command = ["git", "-C", str(root), "describe", "--always", "--dirty", "--exclude=*"]
    try:
        done = subprocess.run(
            [*command, "--abbrev=12"], capture_output=True, text=True, check=False
        )
    except OSError:
        return ""
    return done.stdout.strip()


def _hash(files: Iterable[Path], folder: Path) -> str:
    found = hashlib.sha256()
    for file in files:
        content = file.read_bytes()
        found.update(f"{file.relative_to(folder).as_posix()} {len(content)} ".encode() + content)
    return found.hexdigest()[:DIGITS]


@lru_cache(maxsize=2)
def _our_hash(learning: bool) -> str:
    names = (*DECISIVE, *(("learning",) if learning else ()))
    places = [_PACKAGE / name for name in names]
    files = [file for one in places for file in sorted(one.rglob("*.py")) or [one]]
    code = _hash(files, _PACKAGE)
    models = _hash(sorted(models_folder().glob("*.xml")), models_folder())
    return hashlib.sha256(f"{code} {models}".encode()).hexdigest()[:DIGITS]


def our_code(libraries: Iterable[str] = (), learning: bool = False) -> Code:
    """Our code that decides numbers, with its libraries; the training code if asked for."""
    found = {name: _version(name) for name in sorted({*USUAL, *libraries})}
    versions = {name: text for name, text in found.items() if text}
    return Code({"mjforage": _our_hash(learning)}, versions)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""


@lru_cache(maxsize=256)
def outside_code(made: Callable[..., Any]) -> Code:
    """Code of a class that is not ours: all files of its package, or of its module alone.

    As it is when first asked for: a class does not change in a process.
    """
    if is_ours(made):
        return Code({}, {})
    if source := getattr(made, "source_hash", ""):  # of a policy that was given as an object
        return Code({made.__name__: source}, {})
    name, path = made.__module__.partition(".")[0], _file(made.__module__.partition(".")[0])
    if path is None:  # a folder without an __init__.py
        name, path = made.__module__, _file(made.__module__)
    if path is None:
        return Code({name: f"unreadable-{uuid.uuid4().hex[:DIGITS]}"}, {})
    files, folder = [path], path.parent
    if path.name == "__init__.py":
        files = sorted(one for one in folder.rglob("*") if one.suffix in _SUFFIXES)
    return Code({name: _hash(files, folder)}, {})


def _file(module: str) -> Path | None:
    file = getattr(sys.modules.get(module), "__file__", None)
    return Path(file).resolve() if file else None
