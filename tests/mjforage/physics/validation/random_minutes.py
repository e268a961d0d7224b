"""How far the fast integrator is off in random minutes of hard weather.

`python -m tests.mjforage.physics.validation.random_minutes --json FILE`, by `make evidence`.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.vessel_checks import STEP_S, Float64Array
from mjforage.physics.vessels import Vessel, load_vessel
from tests.mjforage.physics.validation.measures import Measures, at_most, check
from tests.mjforage.physics.validation.runs import CASES, case_name

MINUTES, FEW = 200, 24
WIND_MPS, CURRENT_MPS = 12.0, 0.5  # at most
CHANGE_S, SECONDS = 5.0, 60.0  # of commands
FINE_S = 0.0025


class Weather(NamedTuple):
    """Commands and surroundings of random minutes."""

    share: Float64Array  # (part, minute, 2) of the full commands, ahead or astern
    yaw: Float64Array  # (minute,) at the start, at rest in the water
    wind: Float64Array  # (minute, 2) [m/s]
    current: Float64Array  # (minute, 2) [m/s]


def drawn(minutes: int, seed: int) -> Weather:
    """Random minutes: directions, speeds and commands are uniform."""
    rng = np.random.default_rng(seed)

    def flow(most: float) -> Float64Array:
        speed, way = rng.uniform(0.0, most, minutes), rng.uniform(0.0, 2.0 * np.pi, minutes)
        return np.stack((speed * np.cos(way), speed * np.sin(way)), axis=1)

    wind, current = flow(WIND_MPS), flow(CURRENT_MPS)
    share = rng.uniform(-1.0, 1.0, (round(SECONDS / CHANGE_S), minutes, 2))
    return Weather(share, rng.uniform(0.0, 2.0 * np.pi, minutes), wind, current)


def tracks(
    vessel: Vessel, load: float, weather: Weather, integrator: Integrator, step_s: float
) -> NDArray[np.float64]:
    """(tick, minute, 2) positions every 0.1 s [m]."""
    minutes = len(weather.yaw)
    simulation = Simulation(build_scene([vessel]), minutes, integrator=integrator, step_s=step_s)
    pose, velocity = np.zeros((2, minutes, 1, 3))
    pose[:, 0, 2], velocity[:, 0, :2] = weather.yaw, weather.current
    simulation.place_vessels(pose, velocity)
    simulation.vessel_wind[:, 0], simulation.vessel_water[:, 0] = weather.wind, weather.current
    simulation.load[:] = load
    low, high = vessel.thruster.command_range
    rows = []
    for share in weather.share:
        simulation.commands[:, 0] = np.where(share > 0.0, share * high, -share * low)
        for _ in range(round(CHANGE_S / STEP_S)):
            simulation.step(round(STEP_S / step_s))
            rows.append(simulation.vessel_pose[:, 0, :2].copy())
    return np.array(rows)


def distances(vessel: Vessel, load: float, minutes: int, seed: int = 0) -> Float64Array:
    """(minute,) largest distance of the fast integrator from Runge-Kutta in steps of 2.5 ms [m]."""
    weather = drawn(minutes, seed)
    true = tracks(vessel, load, weather, Integrator.REFERENCE, FINE_S)
    fast = tracks(vessel, load, weather, Integrator.FAST, Integrator.FAST.step_s)
    return np.asarray(np.hypot(*(fast - true).transpose(2, 0, 1)).max(axis=0))


@check("random-minutes", "12c")
def random_minutes() -> Measures:
    """Commands that change every 5 s, in wind of up to 12 m/s and current of up to 0.5 m/s.

    The worst minutes are those of hulls that go astern, which is unstable: what they are off says
    how long it lasts. So the median and nine of ten are limited.
    """
    found: Measures = []
    for name, load in CASES:
        if name == "ideal":  # no real hull: it goes through its lag in half a step
            continue
        off = distances(load_vessel(name), load, FEW)
        label = f"{case_name(name, load)}, fast"
        found += [
            at_most(f"{label}: median", float(np.median(off)), 0.005, "m"),
            at_most(f"{label}: nine of ten", float(np.quantile(off, 0.9)), 0.015, "m"),
        ]
    return found


def main(words: Sequence[str]) -> None:
    """Write the distances of all shipped vessels."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, required=True)
    options, rows = parser.parse_args(words), []
    for name, load in CASES:
        off = 1e3 * distances(load_vessel(name), load, MINUTES)
        rows.append([case_name(name, load), *np.quantile(off, (0.5, 0.9, 0.99, 1.0)).tolist()])
    options.json.write_text(json.dumps(rows, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
