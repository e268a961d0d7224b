"""Tables in docstrings are Markdown's; autodoc reads reStructuredText."""

from typing import Any

from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata

BEFORE_NUMPYDOC = 400


def tables_told(
    app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]
) -> None:
    """Write each Markdown table of a docstring as a list table, in place."""
    told: list[str] = []
    table: list[list[str]] = []
    for line in [*lines, ""]:
        if line.strip().startswith("|"):
            table.append([cell.strip() for cell in line.strip().strip("|").split("|")])
            continue
        if table:
            told += list_table(table)
            table = []
        told.append(line)
    lines[:] = told[:-1] if told and not told[-1] else told


def list_table(table: list[list[str]]) -> list[str]:
    """The lines of a list table; its second row, the dashes, is left out."""
    lines = ["", ".. list-table::", "   :header-rows: 1", ""]
    for row in [table[0], *table[2:]]:
        for place, cell in enumerate(row):
            lines.append(f"   {'* -' if place == 0 else '  -'} {cell}".rstrip())
    return [*lines, ""]


def setup(app: Sphinx) -> ExtensionMetadata:
    """Join autodoc before numpydoc does."""
    app.connect("autodoc-process-docstring", tables_told, priority=BEFORE_NUMPYDOC)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
