import math
from pathlib import Path

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.physics.hydrodynamics.conditions import Conditions, State
from mjforage.physics.manoeuvre import (
    Schedule,
    manoeuvre,
    run_manoeuvre,
    run_test,
    write_trajectory,
)
from mjforage.physics.manoeuvre.trajectory import COLUMNS
from mjforage.physics.manoeuvre.trial import time_grid
from mjforage.physics.vessels import Vessel, load_vessel

OTTER = load_vessel("otter")
AHEAD = Schedule((0.0,), ((60.0, 60.0),))


class Recorder:
    """A vessel that does not move and records its commands."""

    commands: list[tuple[float, float, float]]

    def __init__(self, vessel: Vessel, conditions: Conditions) -> None:
        self.conditions, self.time = conditions, 0.0
        Recorder.commands = []

    def step(self, port: float, starboard: float, step_s: float) -> None:
        self.commands.append((self.time, port, starboard))
        self.time += step_s

    def state(self) -> State:
        return self.conditions.start


class Diverging(Recorder):
    def state(self) -> State:
        return (0.0, 0.0, 0.0, math.inf if self.time > 0.5 else 0.0, 0.0, 0.0)


def test_a_vessel_starts_at_rest_over_ground_with_its_heading() -> None:
    conditions = Conditions(current_mps=(0.3, 0.1), heading_rad=0.7)
    run = run_manoeuvre(OTTER, AHEAD, conditions, duration_s=1.0)
    np.testing.assert_allclose(run.states[0], [0, 0, 0.7, 0, 0, 0], atol=1e-15)
    assert run.times_s[0] == 0.0


def test_rows_are_at_most_0_05_s_apart_from_zero_to_the_end() -> None:
    run = run_manoeuvre(OTTER, AHEAD, duration_s=7.03)
    assert run.times_s[-1] == 7.03
    assert np.diff(run.times_s).max() <= 0.05 + 1e-9
    assert len(run.times_s) == len(run.states) == len(run.commands) == 142


def test_commands_change_when_the_schedule_says_not_at_the_next_step() -> None:
    schedule = Schedule((0.02, 1.013), ((5.0, 6.0), (7.0, 8.0)))
    run_manoeuvre(OTTER, schedule, duration_s=2.0, simulate=Recorder)
    for time, port, starboard in Recorder.commands:
        assert (port, starboard) == schedule.at(time + 1e-6)
    assert any(abs(time - 1.013) < 1e-9 for time, _, _ in Recorder.commands)


def test_duration_is_the_schedule_and_a_minute_unless_given() -> None:
    late = Schedule((0.0, 3.0), ((60.0, 60.0), (0.0, 0.0)))
    assert run_manoeuvre(OTTER, late).times_s[-1] == 63.0


@pytest.mark.parametrize(
    ("duration", "step", "message"),
    [
        (-1.0, 0.05, "--duration -1: give 0.001 s or more"),
        (math.nan, 0.05, "--duration nan: give a finite number of seconds"),
        (10.0, math.nan, "--dt nan: give seconds above 0, at most 0.05"),
        (10.0, 0.06, "--dt 0.06"),
        (1e9, 0.05, "more than 10000000 steps"),
    ],
)
def test_bad_times_are_named(duration: float, step: float, message: str) -> None:
    with pytest.raises(UserError, match=message):
        time_grid(duration, step)


def test_motion_that_is_not_finite_is_an_error_with_its_time() -> None:
    with pytest.raises(UserError, match=r"physics: motion of otter is not finite at t = 0\.55 s"):
        run_manoeuvre(OTTER, AHEAD, duration_s=2.0, simulate=Diverging)


def test_trajectory_reads_back_bit_by_bit(tmp_path: Path) -> None:
    run = run_test(OTTER, "turning-circle", duration_s=20.0)
    write_trajectory(run, tmp_path / "way.csv")
    header = (tmp_path / "way.csv").read_text(encoding="utf-8").splitlines()[0]
    assert header == "t_s,x_m,y_m,yaw_rad,surge_mps,sway_mps,yaw_rate_radps" == ",".join(COLUMNS)
    table = np.loadtxt(tmp_path / "way.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(table[:, 0], run.times_s)
    np.testing.assert_array_equal(table[:, 1:], run.states)


def test_command_line_words_become_a_run(tmp_path: Path) -> None:
    plan = tmp_path / "plan.csv"
    plan.write_text("t_s,left,right\n0,20,20\n", encoding="utf-8")
    run = manoeuvre("scout", plan, current="0.2@90", wind="3@180", heading_deg=90.0, duration_s=5.0)
    expected = run_manoeuvre(
        load_vessel("scout"),
        Schedule((0.0,), ((20.0, 20.0),)),
        Conditions((0.0, 0.2), (-3.0, 0.0), math.pi / 2.0),
        5.0,
    )
    np.testing.assert_array_equal(run.states, expected.states)
    assert manoeuvre("scout", test="drift", duration_s=1.0).test == "drift"
