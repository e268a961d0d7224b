"""A still for readers who asked their system for less motion: a GIF's middle frame, as a PNG.

Pages name the GIF alone; where the site shows it, a `picture` offers the still first.
"""

import re
from pathlib import Path
from typing import Any

from PIL import Image, ImageSequence
from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata

_SHOWN = re.compile(r'<img [^>]*src="(?P<path>[^"]+)\.gif"[^>]*>')


def offer(app: Sphinx, name: str, template: str, context: dict[str, Any], doctree: object) -> None:
    """Put a still before each GIF of a page that is about to be written."""
    context["body"] = _SHOWN.sub(
        r'<picture><source media="(prefers-reduced-motion: reduce)" srcset="\g<path>.png">'
        r"\g<0></picture>",
        context.get("body", ""),
    )


def draw(app: Sphinx, exception: Exception | None) -> None:
    """Write the stills beside the site's copies of the GIFs."""
    for path in sorted(Path(app.outdir, "_images").glob("*.gif")):
        with Image.open(path) as film:
            frames = [frame.copy() for frame in ImageSequence.Iterator(film)]
        frames[len(frames) // 2].save(path.with_suffix(".png"))


def setup(app: Sphinx) -> ExtensionMetadata:
    """Join the writing of pages, and its end."""
    app.connect("html-page-context", offer)
    app.connect("build-finished", draw)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
