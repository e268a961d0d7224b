"""A GIF written frame by frame, so that memory does not grow with its length."""

from collections.abc import Iterator
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import GifImagePlugin
from PIL import Image as PilImage

GIF_MOST_FPS = 50  # viewers slow down frames shorter than 2/100 s
_TICKS = 100.0  # [1/s] GIF counts time in hundredths
_COLOURS = 256
_PATTERN: NDArray[np.int16] = np.array(
    [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]], np.int16
)  # order in which a 4 x 4 block fills (B. E. Bayer, ICC 1973)
_PATTERN_STEP = 0.5  # colour levels per place in that order
_RARE = (
    0.4  # colours count in the palette by this power of their area, so that small hulls keep theirs
)
_MOST_ERROR = 3.0  # mean colour error [0..255] at which the palette is renewed
_CHECKED = 6  # every so-manieth pixel each way is compared


def write_gif(frames: Iterator[NDArray[np.uint8]], file: BinaryIO, fps: float) -> int:
    """Write an endlessly looping GIF of frames (height, width, 3); return their number.

    Only the rectangle that changed is stored. The palette is made for the first frame and again
    whenever it no longer fits, so that still parts do not flicker.

    Raises
    ------
    OSError
        If `file` cannot be written.
    """
    count, shown, palette = 0, None, None
    for frame in frames:
        box = _changed(shown, frame)
        part = PilImage.fromarray(frame).crop(box)
        if palette is None or _misfit(part, palette):
            box, part = (0, 0, frame.shape[1], frame.shape[0]), PilImage.fromarray(frame)
            palette = _make_palette(frame)
        indexed = _to_palette(_patterned(np.asarray(part), box), palette)
        if count == 0:
            _write_header(file, indexed)
        ticks = round((count + 1) * _TICKS / fps) - round(count * _TICKS / fps)
        blocks = GifImagePlugin.getdata(
            indexed, box[:2], duration=10 * ticks, include_color_table=True, disposal=1
        )
        for block in blocks:
            file.write(block)
        shown, count = frame, count + 1
    if count:
        file.write(b";")
    return count


def _write_header(file: BinaryIO, indexed: PilImage.Image) -> None:
    """Screen size without a global palette, then the block that asks for endless looping."""
    width, height = indexed.size
    size = width.to_bytes(2, "little") + height.to_bytes(2, "little")
    file.write(b"GIF89a" + size + b"\x70\x00\x00")
    file.write(b"\x21\xff\x0bNETSCAPE2.0\x03\x01\x00\x00\x00")


def _changed(
    shown: NDArray[np.uint8] | None, frame: NDArray[np.uint8]
) -> tuple[int, int, int, int]:
    """Left, top, right, bottom of what differs; a single pixel where nothing does."""
    if shown is None:
        return 0, 0, frame.shape[1], frame.shape[0]
    differs = np.any(shown != frame, axis=2)
    rows, columns = np.flatnonzero(differs.any(axis=1)), np.flatnonzero(differs.any(axis=0))
    if len(rows) == 0:
        return 0, 0, 1, 1
    return int(columns[0]), int(rows[0]), int(columns[-1]) + 1, int(rows[-1]) + 1


def _make_palette(frame: NDArray[np.uint8]) -> PilImage.Image:
    """Median cut over the frame's colours, told apart by 5 bits per channel."""
    pixels = frame[::2, ::2].reshape(-1, 3)
    code = (pixels >> 3).astype(np.int64) @ np.array([1024, 32, 1])
    _, first, count = np.unique(code, return_index=True, return_counts=True)
    often = np.maximum(1, np.rint(count**_RARE)).astype(np.int64)
    picture = PilImage.fromarray(np.repeat(pixels[first], often, axis=0)[None])
    return picture.quantize(_COLOURS, PilImage.Quantize.MEDIANCUT)


def _patterned(pixels: NDArray[np.uint8], box: tuple[int, int, int, int]) -> NDArray[np.uint8]:
    """Ordered dither, fixed to the screen so that it does not swim."""
    rows = np.arange(box[1], box[3])[:, None] % 4
    columns = np.arange(box[0], box[2]) % 4
    shift = ((_PATTERN[rows, columns] - 7.5) * _PATTERN_STEP).astype(np.int16)
    mixed: NDArray[np.uint8] = np.clip(pixels + shift[..., None], 0, 255).astype(np.uint8)
    return mixed


def _to_palette(pixels: NDArray[np.uint8], palette: PilImage.Image) -> PilImage.Image:
    picture = PilImage.fromarray(np.ascontiguousarray(pixels))
    return picture.quantize(palette=palette, dither=PilImage.Dither.NONE)


def _misfit(part: PilImage.Image, palette: PilImage.Image) -> bool:
    """Whether the colours of `part` are badly met by the palette."""
    pixels = np.asarray(part)[::_CHECKED, ::_CHECKED]
    nearest = _to_palette(pixels, palette).convert("RGB")
    error = np.abs(np.asarray(nearest, np.int16) - pixels)
    return float(error.mean()) > _MOST_ERROR
