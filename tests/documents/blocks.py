"""Fenced blocks of the Markdown pages: their language, their text and what a comment says of them.

A comment on the line before a fence, which no reader sees, says what is to be done with the block:

    <!-- long -->                         over a minute: run by `python -m tests.documents`;
                                          how long, if said, follows: `<!-- long: an hour -->`
    <!-- not run by the tests: REASON --> needs what no test has, such as several machines
    <!-- run by make evidence -->         of a table that `python -m tests.evidence` draws

Every fence names its language: what is `sh` or `python` is run, others are data. A
block whose first line is a comment with a file's name, `# my_policies.py`, is that file.
"""

import re
import textwrap
from dataclasses import dataclass
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
OUTSIDE = ("README.md", "CONTRIBUTING.md", "models/weights/README.md")
"""Pages that are not in docs/."""
SHELL = "sh"
LANGUAGES = (SHELL, "python", "toml", "text", "json", "csv", "bibtex", "console")
MADE = "run by make evidence"

_FENCE = re.compile(r"^( *)```(?P<language>[^\n`]*)\n(?P<text>.*?)^\1```$", re.M | re.S)
_MARK = re.compile(rf"<!-- (?P<mark>long(: \S.*)?|not run by the tests: \S.*|{MADE}) -->")
_FILE = re.compile(r"# (?P<name>[\w-]+\.\w+)\n")


@dataclass(frozen=True)
class Block:
    """A fenced block of a page."""

    page: str  # from the repository's folder
    line: int  # of its opening fence, from 1
    language: str
    text: str
    mark: str  # `long`, `long: HOW LONG`, `not run by the tests: REASON`, `MADE`; "": tests run it

    def __str__(self) -> str:
        return f"{self.page}:{self.line}"

    @property
    def long(self) -> bool:
        """True if it takes over a minute."""
        return self.mark.startswith("long")

    @property
    def file(self) -> str | None:
        """Name of the file that it is, by its first line."""
        found = _FILE.match(self.text)
        return found["name"] if found else None


def pages() -> list[str]:
    """Return the pages whose blocks are run: all in docs/, built ones left out, and `OUTSIDE`."""
    docs = sorted(page.relative_to(REPOSITORY) for page in (REPOSITORY / "docs").rglob("*.md"))
    return [*OUTSIDE, *(str(page) for page in docs if "/_" not in str(page))]


def blocks(page: str) -> list[Block]:
    """Return the blocks of a page, a path from the repository's folder, in order."""
    text = (REPOSITORY / page).read_text("utf-8")
    found = []
    for fence in _FENCE.finditer(text):
        above = text[: fence.start()].rstrip().rpartition("\n")[2].strip()
        mark = _MARK.fullmatch(above)
        line = text.count("\n", 0, fence.start()) + 1
        inner = textwrap.dedent(fence["text"])
        found.append(
            Block(page, line, fence["language"].strip(), inner, mark["mark"] if mark else "")
        )
    return found
