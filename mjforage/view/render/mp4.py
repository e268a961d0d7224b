"""An MP4 of frames, streamed through libav."""

from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray

_ENCODERS = (
    ("libx264", {"preset": "veryfast", "crf": "19"}),
    ("libopenh264", {"b": "8000000"}),
    ("mpeg4", {"qscale": "3"}),
)  # the first that this build of FFmpeg has


def write_mp4(frames: Iterator[NDArray[np.uint8]], path: Path, fps: float) -> int:
    """Write frames (height, width, 3), at least one; return their number.

    Odd sizes are widened by one pixel.

    Raises
    ------
    OSError, av.FFmpegError
        If the file cannot be written.
    """
    frame, count = next(frames, None), 0
    assert frame is not None
    with av.open(str(path), "w", format="mp4", options={"movflags": "faststart"}) as container:
        stream = _video_stream(container, fps, frame.shape[0], frame.shape[1])
        while frame is not None:
            picture = av.VideoFrame.from_ndarray(_even(frame), format="rgb24")
            picture.pts = count
            picture.time_base = 1 / Fraction(stream.codec_context.framerate)
            container.mux(stream.encode(picture))
            frame, count = next(frames, None), count + 1
        container.mux(stream.encode(None))
    return count


def _video_stream(
    container: av.container.OutputContainer, fps: float, height: int, width: int
) -> av.video.stream.VideoStream:
    name, options = next((n, o) for n, o in _ENCODERS if _has_encoder(n))
    rate = Fraction(fps).limit_denominator(1001)
    stream = container.add_stream(name, rate=rate, options=dict(options))
    assert isinstance(stream, av.video.stream.VideoStream)
    stream.width, stream.height = width + width % 2, height + height % 2
    stream.pix_fmt = "yuv420p"
    return stream


def _has_encoder(name: str) -> bool:
    try:
        av.codec.Codec(name, "w")
    except av.codec.codec.UnknownCodecError:
        return False
    return True


def _even(frame: NDArray[np.uint8]) -> NDArray[np.uint8]:
    height, width = frame.shape[:2]
    if height % 2 == 0 and width % 2 == 0:
        return np.ascontiguousarray(frame)
    return np.pad(frame, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")
