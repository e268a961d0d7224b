"""Which code decides a run's numbers: the files that its modules reach by their imports.

Imports are read from the source, those within functions and by `import_module` of a written name
too; those for type checkers alone are not. A user's own modules are followed as ours are; of
installed libraries the versions count. Documentation, drawings and policies that a run does not
play are never reached.
"""

import ast
import hashlib
import subprocess
import sys
import sysconfig
import uuid
from collections.abc import Iterable, Iterator
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, packages_distributions, version
from importlib.util import find_spec
from pathlib import Path, PurePosixPath
from typing import NamedTuple

OURS = ("mjforage",)
COMPUTING = ("numpy", "numba", "scipy", "mujoco", "ortools", "torch", "torchrl")
"""Libraries whose version may change a number; the others that we use store, draw or talk."""
WHOLE = ("mjforage.metrics", "mjforage.mission.mission_metrics")
"""Packages that count whole, as they are read as they stand and not by name."""
DIGITS = 8
_ROOT = Path(__file__).resolve().parents[2]
_INSTALLED = {Path(sysconfig.get_path(kind)).resolve() for kind in ("purelib", "platlib")}
_IMPORTING = ("import_module", "__import__")
_STATEMENTS = (ast.stmt, ast.excepthandler, ast.match_case)
_SUFFIXES = (".py", ".so", ".pyd")
_UNREADABLE = f"unreadable-{uuid.uuid4().hex[:DIGITS]}"  # another one in every process


class Code(NamedTuple):
    """What decides numbers, as `run.json` keeps it."""

    files: dict[str, str]  # path below the folder that it is imported from -> hash
    versions: dict[str, str]  # distribution -> version

    def joined(self, other: "Code") -> "Code":
        """Both, sorted."""
        return Code(
            dict(sorted({**self.files, **other.files}.items())),
            dict(sorted({**self.versions, **other.versions}.items())),
        )


@lru_cache(maxsize=1)
def commit() -> str:
    """Commit of our source, with `-dirty` if files that it has were changed since.

    Empty where the source lies in no repository of its own, or git is missing.
    """
    if not (_ROOT / ".git").exists():
        return ""
    asked = ["git", "-C", str(_ROOT), "describe", "--always", "--dirty", "--exclude=*"]
    try:
        told = subprocess.run([*asked, "--abbrev=12"], capture_output=True, text=True, check=False)
    except OSError:
        return ""
    return told.stdout.strip()


def decisive_code(modules: Iterable[str], whole: Iterable[str] = ()) -> Code:
    """The code that modules reach.

    Parameters
    ----------
    modules : dotted names; a package of a user counts with all its modules
    whole : packages of ours that count with all their modules, as they find those by themselves
    """
    roots = [*modules, *(name for package in whole for name in _modules_of(package))]
    own = {name.partition(".")[0] for name in roots}  # their code counts even where it is installed
    files: dict[str, str] = {}
    libraries: set[str] = set()
    taken: set[str] = set()  # names of others' packages and modules, all files of which are found
    left = list(roots)
    while left:
        name = left.pop()
        top = name.partition(".")[0]
        if top in taken:
            continue
        if not _is_ours(name) and _origin(top) is not None:
            taken.add(top)
        for key, path in _files(name, own):
            if key in files:
                continue
            files[key], imported = _read(path, _package(key))
            left += imported
            tops = {one.partition(".")[0] for one in imported} - own
            libraries |= tops & set(COMPUTING) if _is_ours(name) else tops - set(OURS)
    found = {top: _version(top) for top in libraries if _is_installed(top)}
    return Code(
        dict(sorted(files.items())), {top: text for top, text in sorted(found.items()) if text}
    )


def _is_ours(name: str) -> bool:
    return name.partition(".")[0] in OURS


def _modules_of(package: str) -> Iterator[str]:
    for path in _ROOT.joinpath(*package.split(".")).rglob("*.py"):
        yield ".".join(path.relative_to(_ROOT).with_suffix("").parts).removesuffix(".__init__")


def _files(name: str, own: set[str]) -> list[tuple[str, Path | None]]:
    """Key and path of the files that a module's name stands for; none for libraries."""
    top = name.partition(".")[0]
    if _is_ours(name):
        below = _ROOT.joinpath(*name.split("."))
        paths = (below.with_suffix(".py"), below / "__init__.py")
        return [(path.relative_to(_ROOT).as_posix(), path) for path in paths if path.is_file()]
    if top in sys.stdlib_module_names and top not in own:
        return []
    origin = _origin(top)
    if origin is None:  # folders without an __init__.py, or nothing at all
        origin = _origin(name)
        if origin is None:
            return [(top, None)] if top in own else []
        return [(f"{name.replace('.', '/')}{origin.suffix}", origin)]
    if top not in own and _is_library(top, origin):
        return []
    if origin.name != "__init__.py":
        return [(origin.name, origin)]
    folder = origin.parent
    return [
        (path.relative_to(folder.parent).as_posix(), path)
        for path in sorted(folder.rglob("*"))
        if path.suffix in _SUFFIXES and not any(part[0] == "." for part in path.parts[1:])
    ]


def _origin(name: str) -> Path | None:
    """File of a module, if it has one."""
    loaded = getattr(sys.modules.get(name), "__file__", None)
    if loaded is not None:
        return Path(loaded).resolve()
    try:
        spec = find_spec(name)
    except (ImportError, ValueError):
        return None
    return Path(spec.origin).resolve() if spec and spec.has_location and spec.origin else None


def _package(key: str) -> str:
    """The package from which the relative imports of a file start; empty in a lone script."""
    return ".".join(PurePosixPath(key).parent.parts)


def _read(path: Path | None, package: str) -> tuple[str, set[str]]:
    """Hash of a file, and the names of what it imports."""
    if path is None:
        return _UNREADABLE, set()
    content = path.read_bytes()
    digest = hashlib.sha256(content).hexdigest()[:DIGITS]
    if path.suffix != ".py":
        return digest, set()
    return digest, _imported(content.decode("utf-8", "replace"), package)


@lru_cache(maxsize=1024)
def _imported(text: str, package: str) -> set[str]:
    """Names that a source imports: modules, and what may be modules of a package."""
    names: set[str] = set()
    try:
        left: list[ast.AST] = [ast.parse(text)]
    except (SyntaxError, ValueError, RecursionError):
        return names  # nobody can import it
    calls = any(name in text for name in _IMPORTING)  # else nothing within expressions counts
    while left:
        node = left.pop()
        if isinstance(node, ast.If) and _last_name(node.test) == "TYPE_CHECKING":
            left += node.orelse
            continue
        if isinstance(node, ast.Import):
            names |= {one.name for one in node.names}
        elif isinstance(node, ast.ImportFrom):
            origin = _origin_of(node, package)
            if origin:  # else beyond the topmost package: nobody can import it
                names |= {origin, *(f"{origin}.{one.name}" for one in node.names)}
        elif isinstance(node, ast.Call):
            names |= _imported_by_call(node)
        left += (one for one in ast.iter_child_nodes(node) if calls or isinstance(one, _STATEMENTS))
    return names


def _origin_of(node: ast.ImportFrom, package: str) -> str:
    """The module from which names are imported, a relative one from its package."""
    above = package.split(".")[: len(package.split(".")) - max(0, node.level - 1)]
    return ".".join(filter(None, [*(above if node.level else ()), node.module or ""]))


def _imported_by_call(node: ast.Call) -> set[str]:
    """The module of `importlib.import_module("name")` or `__import__("name")`."""
    first = node.args[0] if node.args else None
    if _last_name(node.func) in _IMPORTING and isinstance(first, ast.Constant):
        return {first.value} if isinstance(first.value, str) and first.value else set()
    return set()


def _last_name(node: ast.expr) -> str:
    """The last part of a dotted name, empty if the expression is none."""
    last = node.attr if isinstance(node, ast.Attribute) else ""
    return node.id if isinstance(node, ast.Name) else last


def _is_installed(top: str) -> bool:
    origin = _origin(top)
    return origin is None or _is_library(top, origin)


def _is_library(top: str, origin: Path) -> bool:
    """Whether a module came with a distribution: into Python's own place for them, or another one,
    such as that of a user or of `pip install --target`, where a record says so.
    """
    if any(place in origin.parents for place in _INSTALLED):
        return True
    return top in _recorded(origin.parents[1] if origin.name == "__init__.py" else origin.parent)


@lru_cache(maxsize=64)
def _recorded(place: Path) -> set[str]:
    """Modules and packages that the records of distributions in a folder name."""
    found: set[str] = set()
    for record in place.glob("*.dist-info/RECORD"):
        lines = record.read_text("utf-8", "replace").splitlines()
        found |= {line.split("/", 1)[0].split(",", 1)[0].partition(".")[0] for line in lines}
    return found


@lru_cache(maxsize=256)
def _version(top: str) -> str:
    """Version of the distribution that a module belongs to; "" if none."""
    try:
        return version(top)
    except PackageNotFoundError:
        found = packages_distributions().get(top, ()) if top not in sys.stdlib_module_names else ()
        named = [name for name in found if name]  # a folder of half a package names none
        return version(named[0]) if named else ""
