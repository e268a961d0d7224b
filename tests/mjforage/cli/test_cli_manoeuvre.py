"""`mjforage manoeuvre` and `vessels`, to the letter of their contract."""

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mjforage.physics.vessel_models import vessel_model
from mjforage.physics.vessels import load_vessel
from mjforage.scenario.vessel_files import vessel_path

COLUMNS = ["t_s", "x_m", "y_m", "yaw_rad", "surge_mps", "sway_mps", "yaw_rate_radps"]


def rows_of(path: Path) -> np.ndarray[Any, np.dtype[np.float64]]:
    with path.open() as file:
        table = list(csv.reader(file))
    assert table[0] == COLUMNS
    return np.array(table[1:], np.float64)


def test_a_schedule_becomes_a_trajectory(command: Callable[..., Any], tmp_path: Path) -> None:
    schedule, out = tmp_path / "in.csv", tmp_path / "out.csv"
    schedule.write_text("t_s,left,right\n0,60,60\n10,40,60\n")
    done = command("manoeuvre", "otter", "--schedule", schedule, "--duration", "30", "--out", out)
    assert done.code == 0, done
    rows = rows_of(out)
    assert rows[0].tolist() == [0.0] * 7
    assert rows[-1, 0] == 30.0 and np.diff(rows[:, 0]).max() <= 0.05 + 1e-12
    straight = rows[rows[:, 0] <= 10.0]
    assert (straight[:, [2, 3]] == 0.0).all() and straight[-1, 4] > 0.8
    # The starboard propeller turns faster: the boat turns to port, yaw grows.
    assert rows[-1, 6] > 0.05 and rows[-1, 3] > 0.5


def test_current_and_heading_are_counter_clockwise_from_east(
    command: Callable[..., Any], tmp_path: Path
) -> None:
    out = tmp_path / "out.csv"
    words = ("--test", "drift", "--current", "0.5@90", "--heading", "90", "--duration", "60")
    assert command("manoeuvre", "otter", *words, "--out", out).code == 0
    last = rows_of(out)[-1]
    assert last[2] > 25.0 and abs(last[1]) < 1e-6  # carried north
    assert last[4] == pytest.approx(0.5, abs=1e-3)  # surge over ground, bow to the north


@pytest.mark.parametrize(("degrees", "axis", "sign"), [(0, 1, 1), (90, 2, 1), (180, 1, -1)])
def test_a_wind_blows_a_hull_to_where_it_is_told(
    command: Callable[..., Any], tmp_path: Path, degrees: int, axis: int, sign: int
) -> None:
    """`--wind 8@90` is 8 m/s to the north: so goes a hull whose thrusters stand still."""
    out = tmp_path / "out.csv"
    words = ("--test", "drift", "--wind", f"8@{degrees}", "--duration", 60, "--out", out)
    assert command("manoeuvre", "scout", *words).code == 0
    rows = rows_of(out)
    assert sign * rows[-1, axis] > 5.0
    half = rows[rows[:, 0] <= 10.0]
    assert (sign * np.diff(half[:, axis]) >= 0.0).all(), "from the first moment on"
    assert np.abs(half[:, 3 - axis]).max() < 0.3 * np.abs(half[:, axis]).max()


def test_a_hull_that_hunts_is_told(
    command: Callable[..., Any], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    text = vessel_path("scout").read_text("utf-8")
    light = text.replace('36.0, unit = "kg"', '1.0, unit = "kg"')
    assert light != text
    (tmp_path / "quite_light.toml").write_text(light, "utf-8")
    words = ("--test", "straight", "--duration", "1")
    for hull in (tmp_path / "quite_light.toml", "scout"):
        assert command("manoeuvre", hull, *words).code == 0
    (line,) = caplog.messages
    assert line.startswith("vessel quite_light: full thrust gives it its cruise speed in 0.094 s")
    assert "it hunts" in line


def test_a_standard_test_prints_its_figures_and_draws(
    command: Callable[..., Any], tmp_path: Path
) -> None:
    plot = tmp_path / "turn.png"
    done = command("manoeuvre", "scout", "--test", "turning-circle", "--plot", plot)
    assert done.code == 0 and "diameter" in done.out
    assert plot.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("ottter", "--test", "stop"), "ottter"),
        (("otter", "--test", "loop"), "loop"),
        (("otter", "--test", "stop", "--plot", "turn.xyz"), "--plot turn.xyz: unknown kind"),
        (("otter", "--test", "stop", "--current=-0.3@0"), "--current -0.3@0: speed"),
        (("otter", "--test", "drift", "--wind", "8@90"), "otter has no [windage] and feels no"),
        (("scout", "--test", "drift", "--wind", "100@0", "--current", "100@200"), "scout"),
    ],
)
def test_bad_manoeuvres_are_refused(
    refused: Callable[..., str], words: tuple[str, ...], named: str
) -> None:
    assert named in refused("manoeuvre", *words)


@pytest.mark.parametrize("option", ["--out", "--plot"])
def test_files_are_checked_before_the_run(
    refused: Callable[..., str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, option: str
) -> None:
    def run(*_: object) -> None:
        raise AssertionError("ran")

    monkeypatch.setattr("mjforage.physics.manoeuvre.manoeuvre", run)
    (tmp_path / "folder.png").mkdir()
    (tmp_path / "file").touch()
    for name in ("none/a.png", "folder.png", "file/a.png"):
        said = refused("manoeuvre", "otter", "--test", "stop", option, tmp_path / name)
        assert f"{name}: cannot be written; name a file in a folder" in said


def test_vessels_are_listed(command: Callable[..., Any]) -> None:
    listed = command("vessels").out
    assert all(name in listed for name in ("otter", "scout", "forager"))


def test_a_vessel_is_printed_as_its_file_to_begin_with(
    command: Callable[..., Any], refused: Callable[..., str]
) -> None:
    schema, _, rest = vessel_path("scout").read_text("utf-8").partition("\n")
    assert schema == "#:schema ../schemas/vessel.json"
    assert command("vessels", "scout").out == rest
    assert "did you mean otter?" in refused("vessels", "oter")


def test_the_tuning_that_a_file_leaves_open_can_be_seen_and_kept(
    command: Callable[..., Any], tmp_path: Path
) -> None:
    own, kept = tmp_path / "own.toml", tmp_path / "kept.toml"
    own.write_text(command("vessels", "scout").out.partition("[control]")[0])
    printed = command("vessels", own).out
    assert printed.startswith(own.read_text()) and 'unit = "rad/s", source = "from mass' in printed
    kept.write_text(printed)
    assert load_vessel(own).control is None and load_vessel(kept).control is not None
    assert vessel_model(load_vessel(kept)) == vessel_model(load_vessel(own))
    assert command("vessels", kept).out == printed
