"""Pictures and films of a run from the command line."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import polars as pl
import pytest
from PIL import Image

from tests.mjforage.cli.short_runs import Refused

pytestmark = pytest.mark.usefixtures("here")


def test_render_draws_a_frame_a_series_and_films(
    command: Callable[..., Any], folder: Path, here: Path
) -> None:
    short = ("--duration", 20, "--fps", 4, "--width", 320)
    for arguments in (
        ("-o", "frame.png", "--episode", 1, "--start", 40),
        ("-o", "film.gif", "--policy", "lawnmower", *short),
        ("--output", "film.mp4", *short),
        ("-o", "beside.mp4", "--beside", "lawnmower", *short, "--height", 241),
        ("-o", "frame-%02d.png", *short),
    ):
        outcome = command("render", folder, *arguments)
        assert (outcome.code, outcome.err) == (0, "")
        kind = "picture" if arguments[1].endswith(".png") else "film"
        assert outcome.out == f"{kind}: {arguments[1]}\n"
    with Image.open("frame.png") as image:
        assert len(image.convert("RGB").getcolors(1 << 24) or ()) > 20
    with Image.open("film.gif") as film:
        assert getattr(film, "n_frames", 1) > 1
    assert b"ftyp" in Path("film.mp4").read_bytes()[:12]
    assert len(list(here.glob("frame-*.png"))) > 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["-o", "a.png", "--episode", 2], "episode 2: give 0 to 1"),
        (["-o", "a.png", "--beside", "pso"], "no episode 0 of pso"),
        (["-o", "a.png", "--camera", "front"], 'Invalid value "front" for --camera'),
        (["-o", "a.png", "--world", "moon"], "no episode 0 of greedy in world moon"),
        (["-o", "a.doc"], "a.doc: unknown kind of file"),
        (["-o", "nowhere/a.png"], "folder nowhere does not exist"),
        (["-o", "a.png", "--start", 81], "start 81 s: the episode lasts from 0 to 80 s"),
        (["-o", "a.mp4", "--fps", 0], "fps 0: must be over 0"),
        (["-o", "a.mp4", "--speed", "-1"], "speed -1: must be over 0"),
        (["-o", "a.mp4", "--duration", "nan"], "duration_s = nan: give a finite number"),
    ],
)
def test_a_film_that_cannot_be_made_is_one_line(
    arguments: list[object],
    words: str,
    refused: Refused,
    here: Path,
    reported: tuple[Path, list[str]],
) -> None:
    assert words in refused("render", reported[0], *arguments)
    assert list(here.iterdir()) == []


def test_render_refuses_a_tampered_log(refused: Refused, folder: Path) -> None:
    path = folder / "agents.parquet"
    pl.read_parquet(path).with_columns(pl.col("x_m") + 1).write_parquet(path)
    assert "does not come out as logged" in refused("render", folder, "-o", "a.png")
    assert not Path("a.png").exists()
