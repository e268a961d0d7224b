"""Text from the DejaVu fonts that matplotlib carries, the same on every machine."""

from functools import lru_cache
from pathlib import Path

import matplotlib
import numpy as np
from numpy.typing import NDArray
from PIL import Image as PilImage
from PIL import ImageDraw, ImageFont

from mjforage.view.render.palette import INK, Colour
from mjforage.view.render.raster import Image, paint_mask


@lru_cache(maxsize=64)
def _font(size: int, bold: bool) -> ImageFont.FreeTypeFont:
    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    path = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / name
    return ImageFont.truetype(path, size, layout_engine=ImageFont.Layout.BASIC)


@lru_cache(maxsize=512)
def _mask(text: str, size: int, bold: bool) -> NDArray[np.uint8]:
    """Coverage of the text (height, width); the top row is the ascent line of the font."""
    font = _font(size, bold)
    ascent, descent = font.getmetrics()
    picture = PilImage.new("L", (width(text, size, bold=bold) + 2, ascent + descent))
    ImageDraw.Draw(picture).text((0, ascent), text, fill=255, font=font, anchor="ls")
    return np.asarray(picture)


def width(text: str, size: int, *, bold: bool = False) -> int:
    """Return the advance width of `text` at `size` [pixel]."""
    return int(np.ceil(_font(size, bold).getlength(text)))


def fit(text: str, size: int, room: float, *, bold: bool = False) -> str:
    """Shorten `text` with an ellipsis until it is at most `room` pixels wide."""
    if width(text, size, bold=bold) <= room:
        return text
    while text and width(text + "…", size, bold=bold) > room:
        text = text[:-1]
    return text.rstrip() + "…"


def write(
    image: Image,
    text: str,
    x: float,
    baseline: float,
    size: int,
    *,
    bold: bool = False,
    colour: Colour = INK,
    align: str = "left",
) -> None:
    """Write one line with its baseline at `baseline`; `align` is left, right or middle."""
    shift = {"left": 0.0, "right": 1.0, "middle": 0.5}[align] * width(text, size, bold=bold)
    top = round(baseline) - _font(size, bold).getmetrics()[0]
    paint_mask(image, _mask(text, size, bold), round(x - shift), top, colour)
