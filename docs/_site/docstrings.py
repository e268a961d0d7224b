"""Additions to autodoc: Markdown tables in docstrings, descriptions of parameters beside their
names, short types of arrays, and fields of named tuples that comments describe.
"""

import ast
import importlib
import inspect
import re
import textwrap
import tokenize
from functools import lru_cache
from io import StringIO
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata

BEFORE_NUMPYDOC = 400

SHORTER = (
    (r"~?(numpy\._typing\._array_like\.)?_Buffer \|.*?complex \| bytes \| str\]", "ArrayLike"),
    (r"~?(numpy\.)?ndarray\[tuple\[.*?\], ~?(numpy\.)?dtype\[([\w.~]+)\]\]", r"ndarray[\3]"),
    (r"Annotated\[(\w+), Within\([^)]*\)\]", r"\1"),
    (r"<factory>|<function <lambda>>", "..."),
    (r"<(?:function|class) ([\w.]+)[^>]*>", r"\1"),
    (r"~(?:\w+\.)*", ""),
    (r"numpy\.(\w+)", r"\1"),
)
"""Pattern in a signature -> its short form."""
DESCRIBED = re.compile(r"(?P<names>[*\w]+(, [*\w]+)*) : (?P<words>.+)")
TYPE = re.compile(r"([A-Z]\w*|str|int|float|bool|callable|None|or|,| )*(, optional)?")


def write_tables(
    app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]
) -> None:
    """Write each Markdown table of a docstring as a list table, in place."""
    new: list[str] = []
    table: list[list[str]] = []
    for line in [*lines, ""]:
        if line.strip().startswith("|"):
            table.append([cell.strip() for cell in line.strip().strip("|").split("|")])
            continue
        if table:
            new += list_table(table)
            table = []
        new.append(line)
    lines[:] = new[:-1] if new and not new[-1] else new


def write_parameters(
    app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]
) -> None:
    """Write `name : description` with the description below the name, in place.

    Signatures have the types; numpydoc takes what stands beside a name for its type.
    """
    new: list[str] = []
    inside = False
    for line, below in zip(lines, [*lines[1:], ""], strict=True):
        if below.startswith("---") and line.strip():
            inside = line.strip() in ("Parameters", "Attributes")
        found = DESCRIBED.fullmatch(line) if inside else None
        if found and not TYPE.fullmatch(found["words"]):
            new += [found["names"], f"    {found['words']}"]
        else:
            new.append(line)
    lines[:] = new


@lru_cache(maxsize=256)
def fields_of(made: type) -> dict[str, str]:
    """Field of a named tuple -> the comment behind it and on lines of its own below."""
    source = textwrap.dedent(inspect.getsource(made))
    comments = {
        token.start[0]: token.string.lstrip("# ")
        for token in tokenize.generate_tokens(StringIO(source).readline)
        if token.type == tokenize.COMMENT
    }
    (tree,) = ast.parse(source).body
    assert isinstance(tree, ast.ClassDef)
    ends = [node.lineno for node in tree.body[1:]] + [len(source.splitlines()) + 1]
    return {
        node.target.id: " ".join(
            comments[line] for line in range(node.lineno, end) if line in comments
        )
        for node, end in zip(tree.body, ends, strict=True)
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)
    }


def write_field(
    app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]
) -> None:
    """Write the comment of a named tuple's field where Python says its number, in place."""
    if not lines or not lines[0].startswith("Alias for field number"):
        return
    place, _, field = name.rpartition(".")
    module, _, made = place.rpartition(".")
    words = fields_of(getattr(importlib.import_module(module), made)).get(field, "")
    lines[:] = [words[:1].upper() + words[1:], ""] if words else [""]


def shorter(text: str | None) -> str | None:
    """A signature, or what it returns, with short names of types."""
    for long, short in SHORTER if text else ():
        text = re.sub(long, short, text or "")
    return text


def write_signature(
    app: Sphinx, what: str, name: str, thing: Any, options: Any, given: str | None, back: str | None
) -> tuple[str | None, str | None]:
    """Write a signature as `shorter` has it."""
    return shorter(given), shorter(back)


def write_annotations(app: Sphinx, document: nodes.document, name: str) -> None:
    """Write the types of attributes as `shorter` has them."""
    for annotation in document.findall(addnodes.desc_annotation):
        text = annotation.astext()
        if (short := shorter(text)) != text:
            annotation.children = [nodes.Text(short or "")]


def list_table(table: list[list[str]]) -> list[str]:
    """The lines of a list table; its second row, the dashes, is left out."""
    lines = ["", ".. list-table::", "   :header-rows: 1", ""]
    for row in [table[0], *table[2:]]:
        for place, cell in enumerate(row):
            lines.append(f"   {'* -' if place == 0 else '  -'} {cell}".rstrip())
    return [*lines, ""]


def setup(app: Sphinx) -> ExtensionMetadata:
    """Join autodoc before numpydoc does."""
    app.connect("autodoc-process-docstring", write_tables, priority=BEFORE_NUMPYDOC)
    app.connect("autodoc-process-docstring", write_parameters, priority=BEFORE_NUMPYDOC)
    app.connect("autodoc-process-docstring", write_field, priority=BEFORE_NUMPYDOC)
    app.connect("autodoc-process-signature", write_signature)
    app.connect("doctree-resolved", write_annotations)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
