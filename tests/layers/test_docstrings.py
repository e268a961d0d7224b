"""Docstrings of the package begin with the thing that they describe."""

import ast
import re
from collections.abc import Iterator

from tests.layers.__main__ import REPOSITORY

QUESTION = re.compile(r"\s*(What|Who|Whether|Where|How|Which|Whose|When|Why)\b")


def _docstrings(tree: ast.AST) -> Iterator[ast.Constant]:
    """Texts that stand alone: below a module, class, function or field."""
    for node in ast.walk(tree):
        match node:
            case ast.Expr(value=ast.Constant(value=str()) as text):
                yield text


def test_they_begin_with_no_question() -> None:
    folders = ("mjforage", "metrics", "controllers", "graph_planner")
    found = [
        f"{path.relative_to(REPOSITORY)}:{text.lineno}: {str(text.value).splitlines()[0]}"
        for folder in folders
        for path in sorted((REPOSITORY / folder).rglob("*.py"))
        for text in _docstrings(ast.parse(path.read_text("utf-8")))
        if QUESTION.match(str(text.value))
    ]
    assert not found, "name the thing instead (`True if`, `Number of`, `Place of`): " + str(found)
