"""Numbers in cells of tables stay on one line; a wide table scrolls."""

import re

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata

NUMBER = re.compile(r"[−+–<>≤≥≈~±×/%,.()\d ]*\d([−+–±×/%,.()\d ]|(to|x|[mµ]?s|h|m|MB)\b)*")
LONGEST = 24


def numbers_whole(app: Sphinx, document: nodes.document, name: str) -> None:
    """Give the class `number` to cells that are one."""
    for cell in document.findall(nodes.entry):
        text = cell.astext()
        if len(text) <= LONGEST and NUMBER.fullmatch(text):
            cell["classes"].append("number")


def setup(app: Sphinx) -> ExtensionMetadata:
    """Look at pages once they are whole."""
    app.connect("doctree-resolved", numbers_whole)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
