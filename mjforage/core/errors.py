"""The error that a user can mend, under the name that every floor of mjforage imports."""

from graph_planner.errors import UserError

__all__ = ["UserError", "printable"]


def printable(text: str) -> str:
    """A text in which what no terminal can show, such as a NUL byte, is escaped."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
