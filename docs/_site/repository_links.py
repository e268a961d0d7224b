"""Links to Markdown files that lie outside docs/ and are pages of the site.

A page that is nothing but an `{include}` of such a file has its text, with its links. In a checkout
a link to the file names the file; on the site it leads to that page. Links to other files of the
repository need no rule: the site holds copies of them.
"""

import os
import re
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata

ROOT = Path(__file__).resolve().parents[2]
PAGES = {  # file of the repository -> page of the site that has its text
    "README.md": "index",
    "CHANGELOG.md": "changelog",
    "CONTRIBUTING.md": "contributing",
    "SECURITY.md": "security",
    "models/weights/README.md": "policies/weights",
}
_TARGET = re.compile(r"\]\((?P<path>[^()\s:#]+)(?=[#)])")
_INCLUDE = re.compile(r"```\{include\} (?P<path>\S+)\n```\s*")


def to_pages(app: Sphinx, name: str, content: list[str]) -> None:
    """Turn such links of a page that is about to be parsed, in place."""
    folder = base = Path(app.env.doc2path(name)).parent
    if included := _INCLUDE.fullmatch(content[0]):
        file = (folder / included["path"]).resolve()
        app.env.note_dependency(os.fspath(file))
        content[0], base = file.read_text(encoding="utf-8"), file.parent

    def turned(match: re.Match[str]) -> str:
        there = (base / match["path"]).resolve()
        page = PAGES.get(os.path.relpath(there, ROOT).replace(os.sep, "/"))
        path = os.path.relpath(there, folder).replace(os.sep, "/")
        if page:
            return f"](/{page}.md"
        return f"]({path}" if included else match[0]

    content[0] = _TARGET.sub(turned, content[0])


def setup(app: Sphinx) -> ExtensionMetadata:
    """Join the reading of sources."""
    app.connect("source-read", to_pages)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
