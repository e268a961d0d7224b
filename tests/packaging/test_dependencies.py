"""What the packages import is declared: always needed, or in an extra."""

import ast
import re
import sys
import tomllib
from glob import glob
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

from tests.packaging.contents import REPOSITORY

PROJECT = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))["project"]
UNDECLARED = {
    "tensordict": "comes with torchrl, which declares it",
}
NO_IMPORT = {"tensorboard": "torch.utils.tensorboard imports it", "pyopengl": "imported as OpenGL"}


def name_of(requirement: str) -> str:
    """The distribution of a requirement, as in `numpy>=2.1`."""
    letters = [c if c.isalnum() or c in "-_." else " " for c in requirement]
    return "".join(letters).split()[0].lower().replace("_", "-")


def imported(tree: ast.Module) -> set[str]:
    """Top-level names that a module imports anywhere."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found.add(node.module.split(".")[0])
    return found


@pytest.fixture(scope="module")
def needed() -> dict[str, str]:
    """Distribution -> a file that imports it; those of Python itself and ours left out."""
    owners, found = packages_distributions(), {}
    files = glob(f"{REPOSITORY}/mjforage/**/*.py", recursive=True)  # noqa: PTH207 - follows links
    for file in map(Path, sorted(files)):
        names = imported(ast.parse(file.read_text("utf-8")))
        for name in names - set(sys.stdlib_module_names) - {"mjforage"}:
            owner = owners.get(name, [name])[0].lower().replace("_", "-")
            found[owner] = str(file.relative_to(REPOSITORY))
    return found


def test_whatever_is_imported_is_declared(needed: dict[str, str]) -> None:
    extras = PROJECT["optional-dependencies"]
    declared = {name_of(line) for line in PROJECT["dependencies"]}
    declared |= {name_of(line) for key in extras if key != "dev" for line in extras[key]}
    missing = {name: file for name, file in needed.items() if name not in declared}
    assert missing.keys() == UNDECLARED.keys(), missing


def test_whatever_is_declared_is_imported(needed: dict[str, str]) -> None:
    declared = {name_of(line) for line in PROJECT["dependencies"]}
    assert declared - needed.keys() - NO_IMPORT.keys() == set()


def test_an_import_in_a_function_counts() -> None:
    assert imported(ast.parse("def f():\n    from a.b import c\n    import d.e\n")) == {"a", "d"}


def test_constraints_have_every_requirement() -> None:
    lines = (REPOSITORY / "constraints.txt").read_text("utf-8").splitlines()
    fixed = {name_of(line) for line in lines if line and not line.startswith("#")}
    extras = PROJECT["optional-dependencies"].values()
    asked = {name_of(line) for part in (PROJECT["dependencies"], *extras) for line in part}
    assert asked - fixed - {"mjforage"} == set()


def test_classifiers_name_the_pythons_that_are_asked_for() -> None:
    start = "Programming Language :: Python :: 3."
    minors = [int(c.removeprefix(start)) for c in PROJECT["classifiers"] if c.startswith(start)]
    assert PROJECT["requires-python"] == f">=3.{min(minors)}"
    assert minors == list(range(min(minors), max(minors) + 1))


def test_the_package_is_typed() -> None:
    assert Path(REPOSITORY, "mjforage", "py.typed").is_file()


def test_lowest_versions_are_those_that_are_allowed() -> None:
    """`make lowest` tries each lower bound of what is not left out; a bound has one form."""
    lines = (REPOSITORY / "lowest.txt").read_text("utf-8").splitlines()
    lowest = dict(line.split("==") for line in lines if line and not line.startswith("#"))
    extras = PROJECT["optional-dependencies"]
    for line in (*PROJECT["dependencies"], *extras["film"], *extras["cluster"]):
        bound = re.search(r">=([\d.]+)", line)
        assert bound is not None, line
        assert _numbers(lowest[name_of(line)]) == _numbers(bound[1]), line


def test_what_is_patched_has_an_upper_bound() -> None:
    assert any(re.fullmatch(r"numba>=[\d.]+,<0\.\d+", line) for line in PROJECT["dependencies"])


def test_the_base_has_nothing_that_an_extra_brings() -> None:
    extras = PROJECT["optional-dependencies"]
    base = {name_of(line) for line in PROJECT["dependencies"]}
    for extra in ("cluster", "film", "learn", "libraries", "orienteering"):
        assert base.isdisjoint(map(name_of, extras[extra])), extra


def _numbers(version: str) -> list[int]:
    """The parts of a version, without zeros at its end: 2025.1 is 2025.1.0."""
    parts = list(map(int, version.split(".")))
    while parts and not parts[-1]:
        parts.pop()
    return parts
