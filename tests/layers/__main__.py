"""Write the picture of the layers into CONTRIBUTING.md: `python -m tests.layers`.

The layers are those that import-linter keeps, with the folders of each package.
"""

import ast
import re
import textwrap
import tomllib
from collections.abc import Iterator
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
PAGE = REPOSITORY / "CONTRIBUTING.md"
WIDTH = 110
DRAWN = re.compile(
    r"(?P<head>^<!-- Drawn by `python -m tests.layers`. -->\n```text\n).*?(?=^```$)", re.S | re.M
)


def layers() -> list[list[str]]:
    """Return the layers from the top; packages of one layer may not import each other."""
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    (contract,) = (one for one in contracts if one["type"] == "layers")
    return [line.replace(".", "/").split(" | ") for line in contract["layers"]]


def entry(package: str) -> Iterator[str]:
    """Yield the lines of a package: name and purpose, then its folders that hold modules."""
    source = (REPOSITORY / package / "__init__.py").read_text("utf-8")
    words = " ".join((ast.get_docstring(ast.parse(source)) or "").split())
    parts = sorted(path.parent.name for path in (REPOSITORY / package).glob("*/__init__.py"))
    lines = textwrap.wrap(words.partition(". ")[0].rstrip("."), WIDTH - 44)
    lines += [f"  {line}" for line in textwrap.wrap("  ".join(parts), WIDTH - 46)]
    for name, line in zip([package, *[""] * len(lines)], lines, strict=False):
        yield f"| {name:<40}{line:<{WIDTH - 44}} |\n"


def picture() -> str:
    """Return the picture, a layer between two lines."""
    rule = "+" + "-" * (WIDTH - 2) + "+\n"
    drawn = ["".join(line for package in layer for line in entry(package)) for layer in layers()]
    return f"{'no import points up':^{WIDTH}}".rstrip() + "\n" + rule + rule.join(drawn) + rule


def renewed(text: str) -> str:
    """Return a page with the picture of today."""
    new, count = DRAWN.subn(lambda found: found["head"] + picture(), text)
    assert count == 1, f"{count} places for the picture in {PAGE.name}, 1 expected"
    return new


if __name__ == "__main__":
    PAGE.write_text(renewed(PAGE.read_text("utf-8")))
