"""Pictures that serve who needs more than a picture: films have stills, charts scroll.

Pages name the GIF or PNG alone. Where readers asked their system for less motion, the site shows a
GIF's middle frame instead. A chart is a wide PNG in a paragraph of its own, whose words would be
lost on a narrow window: that scrolls it (`site.css`), and keys do so too, as it can be tabbed to.
Maps and scenes fit the window.
"""

import re
from pathlib import Path
from typing import Any

from PIL import Image, ImageSequence
from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata

_FILM = re.compile(r'<img [^>]*src="(?P<path>[^"]+)\.gif"[^>]*>')
_ALONE = re.compile(r'<p>(?=<img [^>]*src="[^"]*?(?P<file>[^"/]+\.png)"[^>]*></p>)')
_CHART_WIDTH = 900  # pixels
_CHART_SHAPE = 1.5  # width by height


def offer(app: Sphinx, name: str, template: str, context: dict[str, Any], doctree: object) -> None:
    """Put a still before each GIF of a page that is about to be written, and mark its charts."""
    files = {file: Path(app.srcdir, source) for source, (_, file) in app.env.images.items()}

    def alone(found: re.Match[str]) -> str:
        if found["file"] not in files:  # of which Sphinx has warned
            return found[0]
        with Image.open(files[found["file"]]) as picture:
            width, height = picture.size
        chart = width >= _CHART_WIDTH and width > _CHART_SHAPE * height
        return '<p class="chart" tabindex="0">' if chart else found[0]

    context["body"] = _FILM.sub(
        r'<picture><source media="(prefers-reduced-motion: reduce)" srcset="\g<path>.png">'
        r"\g<0></picture>",
        _ALONE.sub(alone, context.get("body", "")),
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
