"""`mjforage manoeuvre` as one function: words of the command line in, a trajectory out."""

import math
from pathlib import Path

from mjforage.base.cached import warn_once
from mjforage.base.errors import UserError
from mjforage.physics.hydrodynamics.conditions import Conditions
from mjforage.physics.manoeuvre.schedule import read_schedule
from mjforage.physics.manoeuvre.trajectory import Trajectory
from mjforage.physics.manoeuvre.trial import STEP_S, run_manoeuvre, run_test
from mjforage.physics.run_warnings import vessel_warnings
from mjforage.physics.vessels import load_vessel
from mjforage.scenario.bearings import direction

MOST_DEG = 3600.0  # ten turns; far beyond, a heading has no exact sine
FASTEST_MPS = 100.0  # of wind or current that is accepted: faster than any hurricane


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
    loaded, wind_mps = load_vessel(vessel), parse_flow(wind, "--wind")
    if any(wind_mps) and not loaded.windage.any:
        raise UserError(
            f"--wind {wind}: vessel {loaded.name} has no [windage] and feels no wind; give it that "
            "table (`mjforage vessels scout` has one), or leave out --wind"
        )
    step_s = min(dt_s, STEP_S, loaded.lag_s)
    for line in vessel_warnings(loaded, 0.0, step_s, "give --dt of at most"):
        warn_once(f"vessel {loaded.name}: {line}")
    flow, heading = parse_flow(current, "--current"), math.radians(heading_deg)
    conditions = Conditions(flow, wind_mps, heading)
    if schedule is not None:
        rows = read_schedule(schedule, loaded)
        return run_manoeuvre(loaded, rows, conditions, duration_s, dt_s)
    return run_test(loaded, str(test), conditions, duration_s, dt_s)


def parse_flow(text: str, thing: str) -> tuple[float, float]:
    """Velocity (east, north) [m/s] of `0.3@90`: 0.3 m/s towards 90 degrees, which is north.

    Parameters
    ----------
    text : speed [m/s], then `@`, then the direction it flows to, in degrees counter-clockwise from
        east
    thing : name in error messages, for example `--current`

    Raises
    ------
    UserError
        If it is not two finite numbers, or the speed is negative or above 100 m/s.
    """
    speed_text, separator, direction_text = text.partition("@")
    try:
        speed, degrees = float(speed_text), float(direction_text)
    except ValueError:
        speed = math.nan
    if not separator or not math.isfinite(speed) or not math.isfinite(degrees):
        raise UserError(
            f"{thing} {text}: expected SPEED@DIRECTION, for example 0.3@90: "
            "0.3 m/s towards 90 degrees, which is north"
        )
    if not 0.0 <= speed <= FASTEST_MPS:
        raise UserError(f"{thing} {text}: speed is out of range; give 0 to {FASTEST_MPS:g} m/s")
    # Quarter turns are exact, so that 0.3@90 has no part to the east.
    quarters = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}
    angle = direction(degrees)
    east, north = quarters.get(degrees % 360.0, (math.cos(angle), math.sin(angle)))
    return speed * east, speed * north
