"""MP4 and GIF of frames (height, width, 3), streamed through libav in constant memory."""

from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import av.filter
import numpy as np
from numpy.typing import NDArray

Frames = Iterator[NDArray[np.uint8]]
STEADY = 12  # of 255: by how much a GIF's colour may differ from the frame's and stay
_MP4 = (
    ("libx264", {"preset": "veryfast", "crf": "19"}),
    ("libopenh264", {"b": "8000000"}),
    ("mpeg4", {"qscale": "3"}),
)  # the first that this build of FFmpeg has
_TICK_S = Fraction(1, 100)  # in which GIF counts time
# Ordered dither is fixed to the screen, so that still parts do not flicker, and small.
_DITHER = "diff_mode=rectangle:dither=bayer:bayer_scale=5"


def write_mp4(frames: Frames, path: Path, fps: float) -> int:
    """Write frames, at least one, as an MP4; odd sizes are widened by one pixel.

    Raises `OSError, av.FFmpegError` if the file cannot be written.
    """
    name, options = next(one for one in _MP4 if one[0] in av.codecs_available)
    with av.open(str(path), "w", format="mp4", options={"movflags": "faststart"}) as container:
        encoded = _encode(_even(frames), container, name, _rate(fps), "yuv420p", options)
        return sum(1 for _ in encoded)


def write_gif(frames: Frames, path: Path, fps: float) -> int:
    """Write frames, at least one, as an endless GIF with one palette.

    The palette is known only after the last frame, so frames wait in a lossless film beside `path`.
    A pixel keeps its colour until red, green or blue is off by more than `STEADY`, for GIF stores
    what changes: glittering water makes films tenfold. Raises `OSError, av.FFmpegError` if a file
    cannot be written.
    """
    film = path.with_name(f"{path.name}.mkv")
    try:
        with av.open(str(film), "w", format="matroska") as container:
            encoded = _encode(steadied(frames), container, "ffv1", Fraction(25), "bgr0", {})
            count, palette = _palette(encoded)
        with av.open(str(film)) as source, av.open(str(path), "w", format="gif") as container:
            _paint(source, container, palette, fps)
        return count
    finally:
        film.unlink(missing_ok=True)


def steadied(frames: Frames) -> Frames:
    """Yield frames (height, width, 3); a pixel stays until it is off by more than `STEADY`."""
    steady = None
    for frame in frames:
        if steady is None:
            steady = frame.copy()  # its owner may paint over it
        else:
            off = np.maximum(frame, steady) - np.minimum(frame, steady)
            steady = np.where((off > STEADY).any(axis=-1, keepdims=True), frame, steady)
        yield steady


def _encode(
    frames: Frames, container: Any, codec: str, rate: Fraction, pixels: str, options: dict[str, str]
) -> Iterator[av.VideoFrame]:
    """Write frames into a container, and yield each when it is written."""
    stream = None
    for number, frame in enumerate(frames):
        picture = av.VideoFrame.from_ndarray(np.ascontiguousarray(frame), format="rgb24")
        if stream is None:
            stream = container.add_stream(codec, rate=rate, options=options)
            stream.width, stream.height, stream.pix_fmt = picture.width, picture.height, pixels
        picture.pts, picture.time_base = number, 1 / rate
        container.mux(stream.encode(picture))
        yield picture
    assert stream is not None, "no frames"
    container.mux(stream.encode(None))


def _rate(fps: float) -> Fraction:
    return Fraction(fps).limit_denominator(1001)


def _even(frames: Frames) -> Frames:
    for frame in frames:
        height, width = frame.shape[:2]
        yield np.pad(frame, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")


def _palette(pictures: Iterator[av.VideoFrame]) -> tuple[int, Any]:
    """Number of pictures, and the palette of all of them."""
    graph: Any = av.filter.Graph()  # its stubs know fewer formats than it does
    source, count = None, 0
    for count, picture in enumerate(pictures, start=1):
        if source is None:
            size = {"width": picture.width, "height": picture.height}
            source = graph.add_buffer(**size, format="rgb24", time_base=_TICK_S)
            palette, sink = graph.add("palettegen"), graph.add("buffersink")
            source.link_to(palette)
            palette.link_to(sink)
            graph.configure()
        picture.pts, picture.time_base = count, _TICK_S
        source.push(picture)
    assert source is not None, "no frames"
    source.push(None)
    return count, graph.pull()


def _paint(film: Any, container: Any, palette: Any, fps: float) -> None:
    """The frames of a film in the colours of a palette, as a GIF."""
    video = film.streams.video[0]
    stream = container.add_stream("gif", rate=_rate(fps))
    stream.width, stream.height, stream.pix_fmt = video.width, video.height, "pal8"
    graph: Any = av.filter.Graph()
    size = {"width": video.width, "height": video.height}
    pictures = graph.add_buffer(**size, format="bgr0", time_base=_TICK_S)
    size = {"width": palette.width, "height": palette.height}
    colours = graph.add_buffer(**size, format="bgra", time_base=_TICK_S)
    paint = graph.add("paletteuse", _DITHER)
    pictures.link_to(paint, 0, 0)
    colours.link_to(paint, 0, 1)
    paint.link_to(graph.add("buffersink"))
    graph.configure()
    colours.push(palette.reformat(format="bgra"))
    colours.push(None)
    for number, picture in enumerate(film.decode(video=0)):
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
