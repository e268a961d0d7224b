"""Runs that several checks share: all shipped vessels, and the independent ones."""

from collections.abc import Iterator
from functools import cache, partial

import numpy as np

from mjforage.physics.hydrodynamics.conditions import Conditions, to_body
from mjforage.physics.manoeuvre import Trajectory, run_test
from mjforage.physics.simulation import Integrator
from mjforage.physics.vessel_checks import STEP_S, Float64Array, Schedule, command_at
from mjforage.physics.vessels import Vessel, load_vessel
from tests.mjforage.physics.validation.independent import IndependentOtter
from tests.mjforage.physics.validation.momentum import MomentumVessel

VESSELS = ("forager", "ideal", "otter", "scout")
TURN: Schedule = ((0.0, 0.33, 0.15),)  # shares of the largest thrust
CASES = (("forager", 0.0), ("forager", 100.0), ("ideal", 0.0), ("otter", 0.0), ("scout", 0.0))
"""All vessels that ship, and full the one that takes a load."""


def cases(*names: str) -> Iterator[tuple[str, Vessel, float, Integrator]]:
    """Label, vessel, load and integrator of every case, or of those of some vessels."""
    for name, load in CASES:
        for integrator in Integrator:
            if not names or name in names:
                label = f"{case_name(name, load)}, {integrator.value}"
                yield label, load_vessel(name), load, integrator


def case_name(name: str, load: float) -> str:
    """A case in words."""
    return f"{name}, {load:g} items" if load else name


@cache
def independent_run(test: str) -> Trajectory:
    """A standard test of the independent Otter."""
    return run_test(load_vessel("otter"), test, simulate=IndependentOtter)


def momentum_rows(
    vessel: Vessel,
    schedule: Schedule,
    *,
    conditions: Conditions | None = None,
    load: float = 0.0,
    seconds: float = 60.0,
) -> Float64Array:
    """(row, 6) what `run_schedule` gives, of the independent vessel `MomentumVessel`."""
    hull = MomentumVessel(vessel, conditions or Conditions(), load)
    rows = [hull.state()]
    for k in range(round(seconds / STEP_S)):
        hull.step(*command_at(schedule, k * STEP_S), STEP_S)
        rows.append(hull.state())
    return np.array([(x, y, yaw, *to_body((u, v), -yaw), r) for x, y, yaw, u, v, r in rows])


@cache
def momentum_run(test: str, name: str, load: float, seconds: float) -> Trajectory:
    """A standard test of the independent vessel `MomentumVessel`."""
    hull = partial(MomentumVessel, load=load)
    return run_test(load_vessel(name), test, duration_s=seconds, simulate=hull)
