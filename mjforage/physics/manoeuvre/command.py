"""`mjforage manoeuvre` as one function: words of the command line in, a trajectory out."""

import math
from pathlib import Path

from mjforage.base.cached import warn_once
from mjforage.base.errors import UserError
from mjforage.physics.hydrodynamics.conditions import Conditions
from mjforage.physics.manoeuvre.directions import parse_flow
from mjforage.physics.manoeuvre.schedule import read_schedule
from mjforage.physics.manoeuvre.trajectory import Trajectory
from mjforage.physics.manoeuvre.trial import STEP_S, run_manoeuvre, run_test
from mjforage.physics.run_warnings import vessel_warnings
from mjforage.physics.vessels import load_vessel

MOST_DEG = 3600.0  # ten turns; far beyond, a heading has no exact sine


def manoeuvre(
    vessel: str | Path,
    schedule: str | Path | None = None,
    test: str | None = None,
    current: str = "0@0",
    wind: str = "0@0",
    heading_deg: float = 0.0,
    duration_s: float | None = None,
    dt_s: float = STEP_S,
) -> Trajectory:
    """Run one vessel, from rest over ground with its thrusters stopped.

    Parameters
    ----------
    vessel : name of a shipped one, or path of a TOML file
    schedule, test : exactly one of them: path of a CSV file, or name of a standard test
    current, wind : `SPEED@DIRECTION`, m/s and degrees counter-clockwise from east, flowing to
    heading_deg : at the start, counter-clockwise from east
    duration_s : the test's own, or 60 s beyond the schedule's last row, unless given
    dt_s : step of the integration

    Raises
    ------
    UserError
        For anything wrong with these.
    """
    if (schedule is None) == (test is None):
        raise UserError("manoeuvre: give either --schedule FILE.csv or --test NAME")
    if not abs(heading_deg) <= MOST_DEG:  # also catches what is not a number
        raise UserError(
            f"--heading {heading_deg:g}: give degrees, counter-clockwise from east, "
            f"{-MOST_DEG:g} to {MOST_DEG:g}"
        )
    hull = load_vessel(vessel)
    if any(parse_flow(wind, "--wind")) and not hull.windage.any:
        raise UserError(
            f"--wind {wind}: vessel {hull.name} has no [windage] and feels no wind; give it that "
            "table (`mjforage vessels scout` has one), or leave out --wind"
        )
    for line in vessel_warnings(hull, 0.0, min(dt_s, STEP_S, hull.lag_s), "give --dt of at most"):
        warn_once(f"vessel {hull.name}: {line}")
    conditions = Conditions(
        current_mps=parse_flow(current, "--current"),
        wind_mps=parse_flow(wind, "--wind"),
        heading_rad=math.radians(heading_deg),
    )
    if schedule is not None:
        rows = read_schedule(schedule, hull)
        return run_manoeuvre(hull, rows, conditions, duration_s, dt_s)
    return run_test(hull, str(test), conditions, duration_s, dt_s)
