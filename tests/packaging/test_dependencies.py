"""Imports of the package are declared as dependencies: always needed, or in an extra."""

import ast
import sys
import tomllib
from glob import glob
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from tests.packaging.contents import REPOSITORY

PROJECT = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))["project"]
UNDECLARED = {
    "tensordict": "comes with torchrl, which declares it",
}
NO_IMPORT = {"tensorboard": "torch.utils.tensorboard imports it", "pyopengl": "imported as OpenGL"}


def name_of(requirement: str) -> str:
    """The distribution of a requirement, as in `numpy>=2.1`."""
    return canonicalize_name(Requirement(requirement).name)


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


def test_constraints_have_every_requirement() -> None:
    lines = (REPOSITORY / "constraints.txt").read_text("utf-8").splitlines()
    fixed = {name_of(line) for line in lines if line and not line.startswith("#")}
    extras = PROJECT["optional-dependencies"].values()
    asked = {name_of(line) for part in (PROJECT["dependencies"], *extras) for line in part}
    assert asked - fixed - {"mjforage"} == set()


def test_lowest_versions_are_those_that_are_allowed() -> None:
    """`make lowest` tries each lower bound of what is not left out; a bound has one form."""
    lines = (REPOSITORY / "lowest.txt").read_text("utf-8").splitlines()
    lowest = dict(line.split("==") for line in lines if line and not line.startswith("#"))
    extras = PROJECT["optional-dependencies"]
    for line in (*PROJECT["dependencies"], *extras["film"], *extras["cluster"], *extras["places"]):
        (bound,) = [one.version for one in Requirement(line).specifier if one.operator == ">="]
        assert Version(lowest[name_of(line)]) == Version(bound), line
