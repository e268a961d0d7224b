"""Run a schedule or a standard test with anything that moves a vessel, and record its rows."""

import math
from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.physics.hydrodynamics.conditions import Conditions, SimulatedVessel
from mjforage.physics.manoeuvre.schedule import Schedule
from mjforage.physics.manoeuvre.standard import STANDARD_TESTS, Steering
from mjforage.physics.manoeuvre.trajectory import Trajectory
from mjforage.physics.simulation.mujoco_vessel import LONGEST_S, MujocoVessel
from mjforage.physics.vessels import Vessel

Simulate: TypeAlias = Callable[[Vessel, Conditions], SimulatedVessel]
"""Makes a vessel in its start state, thrusters stopped."""

STEP_S = LONGEST_S  # default and longest step, and time between rows
AFTERWARDS_S = 60.0  # how long a run goes on after the last row of its schedule
SHORTEST_S = 1e-3
MOST_STEPS = 10_000_000


def run_manoeuvre(
    vessel: Vessel,
    schedule: Schedule,
    conditions: Conditions | None = None,
    duration_s: float | None = None,
    dt_s: float = STEP_S,
    simulate: Simulate = MujocoVessel,
) -> Trajectory:
    """Run a schedule from rest.

    Parameters
    ----------
    conditions : current, wind, heading; calm and eastwards unless given
    duration_s : 60 s beyond the schedule's last row unless given
    dt_s : step of the integration; steps are shortened to end where a command changes
    simulate : makes the vessel

    Raises
    ------
    UserError
        If duration or step is out of range.
    """
    length = schedule.times_s[-1] + AFTERWARDS_S if duration_s is None else duration_s
    times = time_grid(length, dt_s, schedule.times_s)
    here = conditions or Conditions()
    return _record(vessel, here, "schedule", times, lambda t, _: schedule.at(t + 1e-9), simulate)


def run_test(
    vessel: Vessel,
    test: str,
    conditions: Conditions | None = None,
    duration_s: float | None = None,
    dt_s: float = STEP_S,
    simulate: Simulate = MujocoVessel,
) -> Trajectory:
    """Run a standard test by name; parameters as in `run_manoeuvre`.

    Raises
    ------
    UserError
        If there is no such test, or duration or step is out of range.
    """
    if test not in STANDARD_TESTS:
        raise UserError(f"--test {test}: unknown; {nearest(test, STANDARD_TESTS)}")
    standard = STANDARD_TESTS[test]
    here = conditions or Conditions()
    length = standard.duration_s if duration_s is None else duration_s
    times = time_grid(length, dt_s, standard.marks_s)
    return _record(vessel, here, test, times, standard.steering(vessel, here.heading_rad), simulate)


def time_grid(
    duration_s: float, dt_s: float, marks_s: tuple[float, ...] = ()
) -> NDArray[np.float64]:
    """Times of the steps: multiples of the step, the marks, and the end.

    Raises
    ------
    UserError
        If duration or step is too small, not finite or too large.
    """
    if not math.isfinite(duration_s):
        raise UserError(f"--duration {duration_s:g}: give a finite number of seconds")
    if duration_s < SHORTEST_S:
        raise UserError(f"--duration {duration_s:g}: give {SHORTEST_S:g} s or more")
    if not 0.0 < dt_s <= LONGEST_S:
        raise UserError(f"--dt {dt_s:g}: give seconds above 0, at most {LONGEST_S:g}")
    if duration_s / dt_s > MOST_STEPS:
        raise UserError(
            f"--duration {duration_s:g} with --dt {dt_s:g}: more than {MOST_STEPS} steps; "
            "give a longer step or a shorter run"
        )
    regular = dt_s * np.arange(math.ceil(duration_s / dt_s))
    within = [mark for mark in marks_s if mark < duration_s]
    times = np.unique(np.round(np.concatenate((regular, within, [duration_s])), 9))
    return np.asarray(times)


def _record(
    vessel: Vessel,
    conditions: Conditions,
    test: str,
    times: NDArray[np.float64],
    steering: Steering,
    simulate: Simulate,
) -> Trajectory:
    moved = simulate(vessel, conditions)
    state = moved.state()
    states, commands = [state], [steering(float(times[0]), state)]
    for before, after in zip(times[:-1].tolist(), times[1:].tolist(), strict=True):
        moved.step(*commands[-1], after - before)
        state = moved.state()
        if not all(math.isfinite(value) for value in state):
            raise UserError(
                f"physics: motion of {vessel.name} is not finite at t = {after:g} s; give a "
                "shorter step (--dt), or check the vessel's parameters, wind and current"
            )
        states.append(state)
        commands.append(steering(after, state))
    return Trajectory(vessel, conditions, test, times, np.array(states), np.array(commands))
