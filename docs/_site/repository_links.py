"""Links to Markdown files that lie outside docs/ and are pages of the site.

Such a file is included by a page of this folder. In a checkout a link to it names the file; on the
site it leads to that page. Links to other files of the repository need no rule: the site holds
copies of them.
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
    "models/weights/README.md": "policies/weights",
}
_TARGET = re.compile(r"\]\((?P<path>[^()\s:#]+\.md)(?=[#)])")


def to_pages(app: Sphinx, name: str, content: list[str]) -> None:
    """Turn such links of a page that is about to be parsed, in place."""
    folder = Path(app.env.doc2path(name)).parent

    def turned(match: re.Match[str]) -> str:
        path = (folder / match["path"]).resolve()
        page = PAGES.get(os.path.relpath(path, ROOT).replace(os.sep, "/"))
        return f"](/{page}.md" if page else match[0]

    content[:] = [_TARGET.sub(turned, text) for text in content]


def setup(app: Sphinx) -> ExtensionMetadata:
    """Join the reading of sources."""
    app.connect("source-read", to_pages)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
