"""Share of items that a lone forager collects: `python -m tests.controllers.picking_ground`.

One item at rest in a node, touching or nearly touching its quays where it has any; a forager in the
node or beside it, at any heading, ordered there and then to stay. Real bodies, 0.1 m and 1 degree
of noise. The place of the item is known (0 m), or seen by a camera with a noise of so many metres.
"""

import argparse
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mjforage.base.atomic_files import write_bytes
from mjforage.physics.calibration import Trials, collected_in
from mjforage.physics.calibration.trials import MIDDLE_M, PITCH_M, REST_M, SENSORS
from tests.controllers.proving_ground import say

FloatArray = NDArray[np.float64]

REACH_M = 1.9  # the same in open water, at most
SPREAD_RAD = 0.8  # of headings about the way to the node


def _anyhow(rng: np.random.Generator, trials: int) -> FloatArray:
    return rng.uniform(-np.pi, np.pi, trials)


def _sent(origin: FloatArray, node: FloatArray, item: FloatArray, yaw: FloatArray) -> Trials:
    return Trials(np.column_stack((origin, yaw)), node, item[:, None])


def open_water(rng: np.random.Generator, trials: int) -> Trials:
    """From one of the eight nodes around."""
    node, angle = np.full((trials, 2), MIDDLE_M), 0.25 * np.pi * rng.integers(0, 8, trials)
    way = np.round(np.column_stack((np.cos(angle), np.sin(angle))))
    item = node + rng.uniform(-REACH_M, REACH_M, (trials, 2))
    return _sent(node - PITCH_M * way, node, item, _anyhow(rng, trials))


def straight_quay(rng: np.random.Generator, trials: int) -> Trials:
    """At the east or west quay, from the node or one beside it that is no farther out."""
    side = rng.choice((-1.0, 1.0), trials)
    node = np.column_stack((MIDDLE_M + 2 * PITCH_M * side, np.full(trials, MIDDLE_M)))
    item = node + np.column_stack(
        (side * rng.uniform(*REST_M, trials), rng.uniform(-REACH_M, REACH_M, trials))
    )
    inward = rng.random(trials) < 0.5
    away = np.column_stack((-side * inward, rng.integers(-1, 2, trials)))
    return _sent(node + PITCH_M * away, node, item, _anyhow(rng, trials))


def _corner(rng: np.random.Generator, trials: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    sides = rng.choice((-1.0, 1.0), (trials, 2))
    node = MIDDLE_M + 2 * PITCH_M * sides
    return sides, node, node + sides * rng.uniform(*REST_M, (trials, 2))


def corner_from_within(rng: np.random.Generator, trials: int) -> Trials:
    """In a corner of two quays, from the node itself."""
    _, node, item = _corner(rng, trials)
    return _sent(node, node, item, _anyhow(rng, trials))


def corner_from_beside(rng: np.random.Generator, trials: int) -> Trials:
    """In a corner of two quays, from a node beside it, headed there more or less."""
    sides, node, item = _corner(rng, trials)
    way = sides * np.array([(1, 0), (0, 1), (1, 1)])[rng.integers(0, 3, trials)]
    yaw = np.arctan2(way[:, 1], way[:, 0]) + rng.normal(0.0, SPREAD_RAD, trials)
    return _sent(node - PITCH_M * way, node, item, yaw)


PLACES = (open_water, straight_quay, corner_from_within, corner_from_beside)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a line for every place, by how well items are seen; `--json FILE` writes them, too."""
    parser = argparse.ArgumentParser(prog="python -m tests.controllers.picking_ground")
    parser.add_argument("--trials", type=int, default=400)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args(arguments)
    rows = []
    for noise_m in (0.0, 0.1, 0.2):
        sensors = replace(SENSORS, camera_noise_m=noise_m)
        for place in PLACES:
            drawn = place(np.random.default_rng(options.seed), options.trials)
            decision = collected_in("forager", drawn, 3, options.seed, sensors)
            shares = [float(np.mean(decision <= last)) for last in range(3)]
            words = ", ".join(f"{share:.2f}" for share in shares)
            say(f"{noise_m:g} m, {place.__name__}: {words} within 10, 20, 30 s")
            rows.append({"noise_m": noise_m, "place": place.__name__, "shares": shares})
    if options.json:
        write_bytes(options.json, json.dumps(rows, indent=1).encode())


if __name__ == "__main__":
    main()
