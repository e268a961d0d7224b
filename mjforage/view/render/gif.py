"""A GIF with one palette for the whole film, in constant memory: libav's palette filters.

The palette is known only after the last frame, so frames wait in a lossless film on disk. Pixels
that hardly change are held, for GIF stores what changes: glittering water makes films tenfold.
"""

from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import av.filter
import numpy as np
from numpy.typing import NDArray

HELD = 12  # of 255: by how much a colour may differ from the frame's and stay
_TICK_S = Fraction(1, 100)  # in which GIF counts time
_LOSSLESS, _PIXELS, _COLOURS = "ffv1", "bgr0", "bgra"
# Ordered dither is fixed to the screen, so that still parts do not flicker, and small.
_PAINT = "diff_mode=rectangle:dither=bayer:bayer_scale=5"


def write_gif(frames: Iterator[NDArray[np.uint8]], path: Path, fps: float) -> int:
    """Write an endlessly looping GIF of frames (height, width, 3); return their number.

    A pixel keeps its colour until red, green or blue is off by more than `HELD`.

    Beside it lies, while it is made, a lossless film of a few bits per pixel.

    Raises
    ------
    OSError, av.FFmpegError
        If a file cannot be written.
    """
    film = path.with_name(f"{path.name}.mkv")
    try:
        count, palette = _gather(held(frames), film)
        if palette is not None:
            _paint(film, palette, path, fps)
        return count
    finally:
        film.unlink(missing_ok=True)


def held(frames: Iterator[NDArray[np.uint8]]) -> Iterator[NDArray[np.uint8]]:
    """Yield frames (height, width, 3) whose pixels stay until they are off by more than `HELD`."""
    shown = None
    for frame in frames:
        if shown is None:
            shown = frame.copy()  # its owner may paint over it
        else:
            off = np.maximum(frame, shown) - np.minimum(frame, shown)
            shown = np.where((off > HELD).any(axis=-1, keepdims=True), frame, shown)
        yield shown


def _gather(frames: Iterator[NDArray[np.uint8]], film: Path) -> tuple[int, Any]:
    """Keep the frames in a film; their number and the palette of all of them."""
    frame, count = next(frames, None), 0
    if frame is None:
        return 0, None
    height, width = frame.shape[:2]
    graph = _graph()
    source = graph.add_buffer(width=width, height=height, format="rgb24", time_base=_TICK_S)
    gather = graph.add("palettegen")
    source.link_to(gather)
    gather.link_to(graph.add("buffersink"))
    graph.configure()
    with av.open(str(film), "w", format="matroska") as container:
        stream = _stream(container, _LOSSLESS, Fraction(25), width, height, _PIXELS)
        while frame is not None:
            picture = av.VideoFrame.from_ndarray(np.ascontiguousarray(frame), format="rgb24")
            picture.pts, picture.time_base = count, _TICK_S
            source.push(picture)
            picture.time_base = Fraction(1, 25)
            container.mux(stream.encode(picture))
            frame, count = next(frames, None), count + 1
        container.mux(stream.encode(None))
    source.push(None)
    return count, graph.pull()


def _paint(film: Path, palette: Any, path: Path, fps: float) -> None:
    """The frames of a film in the colours of a palette, as a GIF."""
    with av.open(str(film)) as source, av.open(str(path), "w", format="gif") as container:
        width, height = source.streams.video[0].width, source.streams.video[0].height
        rate = Fraction(fps).limit_denominator(1001)
        stream = _stream(container, "gif", rate, width, height, "pal8")
        graph = _graph()
        pictures = graph.add_buffer(width=width, height=height, format=_PIXELS, time_base=_TICK_S)
        colours = graph.add_buffer(
            width=palette.width, height=palette.height, format=_COLOURS, time_base=_TICK_S
        )
        paint = graph.add("paletteuse", _PAINT)
        pictures.link_to(paint, 0, 0)
        colours.link_to(paint, 0, 1)
        paint.link_to(graph.add("buffersink"))
        graph.configure()
        colours.push(palette.reformat(format=_COLOURS))
        colours.push(None)
        for number, picture in enumerate(source.decode(video=0)):
            picture.pts, picture.time_base = round(number / fps / _TICK_S), _TICK_S
            pictures.push(picture)
            _mux(graph, stream, container)
        pictures.push(None)
        _mux(graph, stream, container)
        container.mux(stream.encode(None))


def _mux(graph: Any, stream: Any, container: Any) -> None:
    """Write the pictures that a graph has finished."""
    while True:
        try:
            picture = graph.pull()
        except (av.BlockingIOError, av.EOFError):
            return
        container.mux(stream.encode(picture))


def _graph() -> Any:
    return av.filter.Graph()  # its stubs know fewer formats than it does


def _stream(
    container: Any, codec: str, rate: Fraction, width: int, height: int, pixels: str
) -> Any:
    stream = container.add_stream(codec, rate=rate)
    stream.width, stream.height, stream.pix_fmt = width, height, pixels
    return stream
