"""Reports without the seconds that printing their figures takes."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from PIL import Image


def _blank_png() -> bytes:
    buffer = io.BytesIO()
    Image.new("RGB", (1, 1)).save(buffer, "PNG")
    return buffer.getvalue()


BLANK = {
    "png": _blank_png(),
    "svg": b'<svg xmlns="http://www.w3.org/2000/svg"/>',
    "pdf": b"%PDF-1.4\n",
}


def _blank(figure: object, letters: object, **options: Any) -> bytes:
    return BLANK[options["format"]]


@contextmanager
def unprinted_figures() -> Iterator[None]:
    """Within it figures are drawn, but printed blank, which saves most of a report's seconds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mjforage.view.page.figure._printed", _blank)
        yield
