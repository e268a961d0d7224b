"""Frames into a file: MP4, GIF, one PNG or numbered PNGs; streamed, and whole or not at all."""

import os
import re
from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PilImage

from mjforage.base.atomic_files import atomic_write
from mjforage.base.errors import UserError
from mjforage.base.extras import require

Frames = Iterator[NDArray[np.uint8]]  # each (height, width, 3)
Writer = Callable[[Frames, Path, float], int]
NUMBERED = re.compile(r"%0?\d*d")
GIF_MOST_FPS = 50  # viewers slow down frames shorter than 2/100 s
_FORMATS = "FILE.mp4, FILE.gif, FILE.png, frames-%04d.png or an existing folder"


def write_video(frames: Frames, path: Path, fps: float) -> int:
    """Write frames in the format of the suffix of `path`, and return their number.

    A folder, or a name with a number pattern such as ``frames-%04d.png``, takes one PNG per frame,
    counted from 0. A file appears under its name only once it is complete; an older one stays until
    then. Odd sizes are widened by one pixel for MP4. Raises `UserError` if the name is of no known
    kind, `fps` does not fit, or the file cannot be written; `ValueError` if there are no frames.
    """
    write = check_target(path, fps)
    count = write(_counted(frames), path, fps)
    if count == 0:
        raise ValueError(f"no frames to write to {path}")
    return count


def check_target(path: Path, fps: float) -> Writer:
    """Return the writer for `path`; call it before a long job to fail early.

    Raises `UserError` as `write_video`.
    """
    if not (np.isfinite(fps) and 0.0 < fps <= 1000.0):
        raise UserError(f"fps {fps:g}: must be over 0 and at most 1000, for example 30")
    if is_numbered(path):
        folder = path if path.is_dir() else path.parent
        writer = _write_pngs
    else:
        folder = path.parent
        known = {".mp4": _write_film, ".gif": _write_film, ".png": _write_png}
        if path.suffix.lower() not in known:
            raise UserError(f"output {path}: unknown kind of file; name {_FORMATS}")
        writer = known[path.suffix.lower()]
        if writer is not _write_png:
            require(f"output {path}", "av")
    if path.suffix.lower() == ".gif" and fps > GIF_MOST_FPS:
        raise UserError(f"fps {fps:g}: a GIF shows at most {GIF_MOST_FPS} frames/s; name an .mp4")
    if not folder.is_dir():
        raise UserError(f"output {path}: folder {folder} does not exist; create it first")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise UserError(f"output {path}: folder {folder} is read-only; choose another")
    return writer


def is_numbered(path: Path) -> bool:
    """True if `path` takes one file per frame."""
    return path.is_dir() or (
        path.suffix.lower() == ".png" and NUMBERED.search(path.name) is not None
    )


def _counted(frames: Frames) -> Frames:
    """Check that every frame has the shape of the first."""
    shape = None
    for frame in frames:
        shape = shape or frame.shape
        if frame.shape != shape or frame.ndim != 3 or frame.shape[2] != 3:
            raise ValueError(
                f"frame of shape {frame.shape}, expected {shape} as (height, width, 3)"
            )
        yield frame


def _write_film(frames: Frames, path: Path, fps: float) -> int:
    """Have libav write frames, if there is one."""
    import av

    from mjforage.view.render.encoders import write_gif, write_mp4

    first = next(frames, None)
    if first is None:
        return 0
    write = write_gif if path.suffix.lower() == ".gif" else write_mp4
    with atomic_write(path, av.FFmpegError) as part:
        return write(chain((first,), frames), part, fps)


def _write_png(frames: Frames, path: Path, fps: float) -> int:
    frame = next(frames, None)
    if frame is None:
        return 0
    if next(frames, None) is not None:
        raise UserError(
            f"output {path}: one PNG holds one frame; name {path.stem}-%04d.png or .mp4"
        )
    _save_png(frame, path)
    return 1


def _write_pngs(frames: Frames, path: Path, fps: float) -> int:
    pattern = path / "frames-%04d.png" if path.is_dir() else path
    (number, *_) = NUMBERED.findall(pattern.name)
    ours = re.compile(NUMBERED.sub(r"\\d+", re.escape(pattern.name), count=1))
    for file in sorted(pattern.parent.iterdir()):
        if ours.fullmatch(file.name):  # old and new frames would mix into one film
            raise UserError(f"output {pattern}: {file.name} is already there; use an empty folder")
    count = 0
    for count, frame in enumerate(frames, start=1):
        name = pattern.name.replace(number, number % (count - 1), 1)
        _save_png(frame, pattern.with_name(name))
    return count


def _save_png(frame: NDArray[np.uint8], path: Path) -> None:
    with atomic_write(path) as part, part.open("wb") as file:
        PilImage.fromarray(frame).save(file, format="PNG", compress_level=4)
