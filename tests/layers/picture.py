"""The picture of the layers that import-linter keeps, with the folders of each package."""

import ast
import textwrap
import tomllib
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).parents[2]
WIDTH = 110
HEAD = "no import points up"


def contracts() -> list[dict[str, Any]]:
    """Return the contracts of import-linter in pyproject.toml."""
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))
    found: list[dict[str, Any]] = project["tool"]["importlinter"]["contracts"]
    return found


def layers() -> list[list[str]]:
    """Return the layers from the top; packages of one layer may not import each other."""
    (contract,) = (one for one in contracts() if one["type"] == "layers")
    return [line.replace(".", "/").split(" | ") for line in contract["layers"]]


def purpose(package: str) -> str:
    """Return the first sentence of a package's docstring."""
    source = (REPOSITORY / package / "__init__.py").read_text("utf-8")
    words = " ".join((ast.get_docstring(ast.parse(source)) or "").split())
    return words.partition(". ")[0].rstrip(".")


def parts(package: str) -> list[str]:
    """Return the folders of a package that hold modules."""
    return sorted(path.parent.name for path in (REPOSITORY / package).glob("*/__init__.py"))


def entry(package: str) -> list[str]:
    """Return the lines of a package: name and purpose, then its folders."""
    lines = textwrap.wrap(purpose(package), WIDTH - 44)
    inside = textwrap.wrap("  ".join(parts(package)), WIDTH - 46)
    told = lines + [f"  {line}" for line in inside]
    return [f"{name:<40}{line}" for name, line in zip([package, *[""] * 9], told, strict=False)]


def picture() -> str:
    """Return the picture, a layer between two lines."""
    rule = "+" + "-" * (WIDTH - 2) + "+"
    drawn = [f"{HEAD:^{WIDTH}}".rstrip(), rule]
    for layer in layers():
        drawn += [f"| {line:<{WIDTH - 4}} |" for package in layer for line in entry(package)]
        drawn.append(rule)
    return "\n".join(drawn) + "\n"
