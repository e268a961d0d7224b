"""Options of commands have a colour of their own, and are not broken at their hyphens."""

from pygments.lexer import inherit
from pygments.lexers.shell import BashLexer
from pygments.token import Name
from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata


class CommandLexer(BashLexer):
    """As for bash, with options."""

    tokens = {"data": [(r"(?<=\s)--?[A-Za-z][\w-]*", Name.Attribute), inherit]}  # noqa: RUF012


def setup(app: Sphinx) -> ExtensionMetadata:
    """Read `sh` blocks so."""
    app.add_lexer("sh", CommandLexer)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
