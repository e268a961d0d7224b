import os
import resource
from collections.abc import Iterator
from pathlib import Path

import av
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image as PilImage

from mjforage.base.errors import UserError
from mjforage.view.render import write_video
from mjforage.view.render.encoders import STEADY, steadied

HEIGHT, WIDTH = 48, 64


def frames(count: int, height: int = HEIGHT, width: int = WIDTH) -> Iterator[NDArray[np.uint8]]:
    """A white square that moves right over blue."""
    for number in range(count):
        frame = np.full((height, width, 3), (40, 90, 160), np.uint8)
        frame[10:26, 4 * number : 4 * number + 16] = 255
        yield frame


def interrupted(error: BaseException) -> Iterator[NDArray[np.uint8]]:
    yield from frames(2)
    raise error


@pytest.mark.parametrize(("height", "width"), [(48, 64), (47, 63)])
def test_mp4_decodes_to_the_frames(tmp_path: Path, height: int, width: int) -> None:
    path = tmp_path / "film.mp4"
    assert write_video(frames(7, height, width), path, 12.5) == 7
    with av.open(str(path)) as film:
        stream = film.streams.video[0]
        decoded = [frame.to_ndarray(format="rgb24") for frame in film.decode(stream)]
        assert stream.average_rate == 12.5
        assert stream.duration is not None
        assert stream.time_base is not None
        assert float(stream.duration * stream.time_base) == pytest.approx(7 / 12.5)
    assert len(decoded) == 7
    assert decoded[0].shape == (48, 64, 3)
    for number, frame in enumerate(decoded):
        assert frame[14:22, 4 * number + 4 : 4 * number + 12].min() > 220
        assert frame[40, 40, 2] > frame[40, 40, 0] + 60


def test_gif_decodes_to_the_frames(tmp_path: Path) -> None:
    path = tmp_path / "film.gif"
    assert write_video(frames(9), path, 30.0) == 9
    with PilImage.open(path) as film:
        assert getattr(film, "n_frames", 1) == 9
        assert film.info["loop"] == 0
        total_ms = 0
        for number, source in enumerate(frames(9)):
            film.seek(number)
            total_ms += film.info["duration"]
            shown = np.asarray(film.convert("RGB"), np.int16)
            assert np.abs(shown - source).max() <= 12
    assert total_ms == 300


def test_a_gif_holds_pixels_that_hardly_change_and_repaints_the_others() -> None:
    """A pixel that creeps is repainted once it is off by more than `STEADY`; one jumps at once."""
    reds = [100, 100 + STEADY, 100 + STEADY + 1, 99, 255]
    source = (np.array([[[red, 7, 7], [5, 5, 5]]], np.uint8) for red in reds)
    found = [frame[0].tolist() for frame in steadied(source)]
    shown = [100, 100, 100 + STEADY + 1, 99, 255]
    assert found == [[[red, 7, 7], [5, 5, 5]] for red in shown]


def test_single_and_numbered_pngs_are_exact(tmp_path: Path) -> None:
    source = list(frames(3))
    assert write_video(iter(source[:1]), tmp_path / "one.png", 30.0) == 1
    np.testing.assert_array_equal(np.asarray(PilImage.open(tmp_path / "one.png")), source[0])
    folder = tmp_path / "frames"
    folder.mkdir()
    write_video(iter(source), folder, 30.0)
    write_video(iter(source), tmp_path / "view%03d.png", 30.0)
    for number, frame in enumerate(source):
        for path in (folder / f"frames-{number:04d}.png", tmp_path / f"view{number:03d}.png"):
            np.testing.assert_array_equal(np.asarray(PilImage.open(path)), frame)


def test_numbered_pngs_do_not_mix_with_old_ones(tmp_path: Path) -> None:
    write_video(frames(2), tmp_path, 30.0)
    with pytest.raises(UserError, match=r"frames-0000\.png is already there"):
        write_video(frames(1), tmp_path, 30.0)


@pytest.mark.parametrize("name", ["film.mp4", "film.gif"])
@pytest.mark.parametrize("error", [KeyboardInterrupt(), ZeroDivisionError()])
def test_interruption_leaves_the_old_file_and_no_other(
    tmp_path: Path, name: str, error: BaseException
) -> None:
    path = tmp_path / name
    path.write_bytes(b"older film")
    with pytest.raises(type(error)):
        write_video(interrupted(error), path, 30.0)
    assert path.read_bytes() == b"older film"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("name", ["film.mp4", "film.gif", "view.png"])
def test_full_disk_is_one_clear_error_and_leaves_nothing(tmp_path: Path, name: str) -> None:
    """A file size limit of the process stands for the full disk."""
    noise = np.random.Generator(np.random.PCG64(0))
    count = 1 if name == "view.png" else 30
    noisy = (noise.integers(0, 256, (120, 160, 3), np.uint8) for _ in range(count))
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, hard))
    try:
        with pytest.raises(UserError, match=rf"{name}: cannot be written \(File too large\)"):
            write_video(noisy, tmp_path / name, 30.0)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "fps", "message"),
    [
        ("film.avi", 30.0, r"film\.avi: unknown kind of file; name FILE\.mp4"),
        ("film", 30.0, "unknown kind of file"),
        ("missing/film.mp4", 30.0, "folder .*missing does not exist"),
        ("missing/%04d.png", 30.0, "folder .*missing does not exist"),
        ("film.mp4", 0.0, "fps 0: must be over 0"),
        ("film.mp4", float("nan"), "fps nan: must be over 0"),
        ("film.gif", 60.0, "fps 60: a GIF shows at most 50"),
    ],
)
def test_bad_targets_are_named(tmp_path: Path, name: str, fps: float, message: str) -> None:
    with pytest.raises(UserError, match=message):
        write_video(frames(1), tmp_path / name, fps)


def test_read_only_folder_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda *_: False)  # root may write anywhere
    with pytest.raises(UserError, match="is read-only; choose another"):
        write_video(frames(1), tmp_path / "film.mp4", 30.0)


def test_one_png_holds_one_frame(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"name view-%04d\.png"):
        write_video(frames(2), tmp_path / "view.png", 30.0)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["film.mp4", "film.gif", "view.png", "%d.png"])
def test_no_frames_and_unequal_frames_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match="no frames"):
        write_video(frames(0), tmp_path / name, 30.0)
    unequal = iter([*frames(1, 48, 64), *frames(1, 48, 66)])
    with pytest.raises(ValueError, match="shape"):
        write_video(unequal, tmp_path / name, 30.0)
