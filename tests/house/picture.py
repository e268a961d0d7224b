"""The house's picture: floors as import-linter forbids to climb them, rooms as folders are."""

import ast
import textwrap
import tomllib
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).parents[2]
WIDTH = 96
ROOF = "no import points up"


def contracts() -> list[dict[str, Any]]:
    """Return the contracts of import-linter in pyproject.toml."""
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))
    found: list[dict[str, Any]] = project["tool"]["importlinter"]["contracts"]
    return found


def floors() -> list[list[str]]:
    """Return the floors from the top; a floor has several packages if none may import another."""
    (contract,) = (one for one in contracts() if one["type"] == "layers")
    return [line.replace(".", "/").split(" | ") for line in contract["layers"]]


def purpose(package: str) -> str:
    """Return the first sentence of a package's docstring."""
    source = (REPOSITORY / package / "__init__.py").read_text("utf-8")
    words = " ".join((ast.get_docstring(ast.parse(source)) or "").split())
    return words.partition(". ")[0].rstrip(".")


def rooms(package: str) -> list[str]:
    """Return the folders of a package that hold modules."""
    return sorted(path.parent.name for path in (REPOSITORY / package).glob("*/__init__.py"))


def entry(package: str) -> list[str]:
    """Return the lines of a package: name and purpose, then its rooms."""
    lines = textwrap.wrap(purpose(package), WIDTH - 24)
    inside = textwrap.wrap("  ".join(rooms(package)), WIDTH - 26)
    told = lines + [f"  {line}" for line in inside]
    return [f"{name:<20}{line}" for name, line in zip([package, *[""] * 9], told, strict=False)]


def picture() -> str:
    """Return the house, a floor between two lines."""
    rule = "+" + "-" * (WIDTH - 2) + "+"
    drawn = [f"{ROOF:^{WIDTH}}".rstrip(), rule]
    for floor in floors():
        drawn += [f"| {line:<{WIDTH - 4}} |" for package in floor for line in entry(package)]
        drawn.append(rule)
    return "\n".join(drawn) + "\n"
