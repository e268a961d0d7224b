"""What share of items a lone forager takes: `python -m tests.controllers.picking_ground`.

One item at rest in a node, touching or nearly touching its quays where it has any; a forager in the
node or beside it, at any heading, ordered there and then to stay. Real bodies, 0.1 m and 1 degree
of noise. The place of the item is known (0 m), or seen by a camera with a noise of so many metres.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from controllers import Chart, Pilot
from graph_planner.randomness import episode_keys
from mjforage.core.scenario import Sensors
from mjforage.physics.dynamics.camera import camera_of
from mjforage.physics.dynamics.picking import MOUTH_DEPTH_M, MOUTH_REACH_M
from mjforage.physics.dynamics.tracks import Tracks, Water, look_out, tracked
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Simulation
from mjforage.physics.vessel_helm import helm_of
from mjforage.physics.vessels import load_vessel
from tests.controllers.proving_ground import say

FloatArray = NDArray[np.float64]

FORAGER = load_vessel("forager")
BASIN, PITCH_M, MIDDLE_M = np.ones((5, 5), np.bool_), 4.0, 8.0
CONTROL_S, PERIOD_S, SEEK_S = 0.1, 10.0, 0.5
NOISE_M, NOISE_RAD = 0.1, np.radians(1.0)
REST_M = (1.85, 1.9)  # from the node's centre, of the middle of an item beside a quay
REACH_M = 1.9  # the same in open water, at most
SPREAD_RAD = 0.8  # of headings about the way to the node


@dataclass(frozen=True)
class Trials:
    """Where hulls begin, where they are sent, where the item lies; (trial, 2) [m], yaw [rad]."""

    origin: FloatArray
    node: FloatArray
    item: FloatArray
    yaw: FloatArray


def _anyhow(rng: np.random.Generator, trials: int) -> FloatArray:
    return rng.uniform(-np.pi, np.pi, trials)


def open_water(rng: np.random.Generator, trials: int) -> Trials:
    """From one of the eight nodes around."""
    node, angle = np.full((trials, 2), MIDDLE_M), 0.25 * np.pi * rng.integers(0, 8, trials)
    way = np.round(np.column_stack((np.cos(angle), np.sin(angle))))
    item = node + rng.uniform(-REACH_M, REACH_M, (trials, 2))
    return Trials(node - PITCH_M * way, node, item, _anyhow(rng, trials))


def straight_quay(rng: np.random.Generator, trials: int) -> Trials:
    """At the east or west quay, from the node or one beside it that is no farther out."""
    side = rng.choice((-1.0, 1.0), trials)
    node = np.column_stack((MIDDLE_M + 2 * PITCH_M * side, np.full(trials, MIDDLE_M)))
    item = node + np.column_stack(
        (side * rng.uniform(*REST_M, trials), rng.uniform(-REACH_M, REACH_M, trials))
    )
    inward = rng.random(trials) < 0.5
    away = np.column_stack((-side * inward, rng.integers(-1, 2, trials)))
    return Trials(node + PITCH_M * away, node, item, _anyhow(rng, trials))


def _corner(rng: np.random.Generator, trials: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    sides = rng.choice((-1.0, 1.0), (trials, 2))
    node = MIDDLE_M + 2 * PITCH_M * sides
    return sides, node, node + sides * rng.uniform(*REST_M, (trials, 2))


def corner_from_within(rng: np.random.Generator, trials: int) -> Trials:
    """In a corner of two quays, from the node itself."""
    _, node, item = _corner(rng, trials)
    return Trials(node, node, item, _anyhow(rng, trials))


def corner_from_beside(rng: np.random.Generator, trials: int) -> Trials:
    """In a corner of two quays, from a node beside it, headed there more or less."""
    sides, node, item = _corner(rng, trials)
    way = sides * np.array([(1, 0), (0, 1), (1, 1)])[rng.integers(0, 3, trials)]
    yaw = np.arctan2(way[:, 1], way[:, 0]) + rng.normal(0.0, SPREAD_RAD, trials)
    return Trials(node - PITCH_M * way, node, item, yaw)


PLACES = (open_water, straight_quay, corner_from_within, corner_from_beside)


class Sight:
    """Where lone foragers take the one item to be."""

    def __init__(self, sensors: Sensors, trials: int, seed: int) -> None:
        ticks = (round(s / CONTROL_S) for s in (sensors.pickup_period_s, sensors.pickup_latency_s))
        self._exact, self._camera = sensors.pickup_noise_m == 0.0, camera_of(sensors, *ticks)
        self._water = Water(Chart(BASIN, PITCH_M).land, PITCH_M)
        self._keys, self._on = episode_keys(seed, np.arange(trials)), np.ones(trials, np.bool_)
        self._items = np.zeros((trials, 1), np.int32)
        self._tracks = Tracks.of(self._camera, 1, self._items)

    def of(self, tick: int, true_pose: FloatArray, pose: FloatArray, xy: FloatArray) -> FloatArray:
        """(trial, 1, 2) [m], NaN where it is not known; to be asked at every tick."""
        if self._exact:
            return xy
        now, out = np.full(len(xy), tick), np.empty((len(xy), 1, 1, 2))
        who = (self._camera, self._water, self._keys, self._on[:1], self._tracks, self._on)
        look_out(*who, now, CONTROL_S, true_pose, pose, xy, self._items)
        tracked(self._tracks, self._water, now, CONTROL_S, out)
        return out[:, 0]


def times_taken(
    trials: Trials, seconds: float, seed: int, sensors: Sensors | None = None
) -> FloatArray:
    """(trial,) when each item was in the mouth [s], infinite if never."""
    rng, n = np.random.default_rng(seed), trials.yaw.size
    sight = Sight(sensors or Sensors(), n, seed)
    scene = build_scene([FORAGER], navigable=BASIN, pitch_m=PITCH_M, items=1)
    simulation = Simulation(scene, n)
    pilot = Pilot([helm_of(FORAGER)], Chart(BASIN, PITCH_M), n, CONTROL_S)
    origin, node = trials.origin[:, None], trials.node[:, None]
    simulation.place_vessels(np.concatenate((origin, trials.yaw[:, None, None]), axis=-1))
    classes = np.full((n, scene.items), -1, np.int64)
    classes[:, 0] = 0
    places = np.array(np.broadcast_to(scene.parking, (n, scene.items, 2)))
    places[:, 0] = trials.item
    simulation.place_items(places, classes)
    taken, everybody = np.full(n, np.inf), np.ones(n, np.bool_)
    for tick in range(round(seconds / CONTROL_S)):
        if tick % round(PERIOD_S / CONTROL_S) == 0:
            stay = (origin == node).all(axis=-1) | (tick > 0)
            pilot.order(everybody, origin, node, stay)
        noise = rng.normal(size=(n, 1, 3)) * (NOISE_M, NOISE_M, NOISE_RAD)
        pose = simulation.vessel_pose + noise
        at = sight.of(tick, simulation.vessel_pose, pose, np.array(simulation.item_xy[:, :1]))
        if tick % round(SEEK_S / CONTROL_S) == 0:
            inside = np.abs(at - node).max(axis=-1) <= 0.5 * PITCH_M
            left = np.isinf(taken)[:, None]
            pilot.collect(np.where((inside & left)[..., None], at, np.nan))
            pilot.look_round(np.isnan(at[..., 0]) & left)
        simulation.commands[:] = pilot.command(everybody, pose, simulation.vessel_velocity)
        simulation.step()
        x, y, yaw = simulation.vessel_pose[:, 0].T
        dx, dy = simulation.item_xy[:, 0, 0] - x, simulation.item_xy[:, 0, 1] - y
        ahead = np.cos(yaw) * dx + np.sin(yaw) * dy - 0.5 * FORAGER.length_m
        aside = np.cos(yaw) * dy - np.sin(yaw) * dx
        in_mouth = (ahead >= -MOUTH_DEPTH_M) & (ahead <= MOUTH_REACH_M)
        in_mouth &= np.abs(aside) <= 0.5 * FORAGER.beam_m
        taken[in_mouth & np.isinf(taken)] = (tick + 1) * CONTROL_S
        gone = np.zeros(simulation.item_class.shape, np.bool_)
        gone[:, 0] = np.isfinite(taken)
        simulation.remove_items(gone & (simulation.item_class >= 0))
    return taken


def main(trials: int = 400, seed: int = 0) -> None:
    """Print a line for every place, by what is seen."""
    fixes = Sensors(NOISE_M, np.degrees(NOISE_RAD))
    for noise_m in (0.0, 0.1, 0.2):
        sensors = replace(fixes, pickup_noise_m=noise_m)
        for place in PLACES:
            taken = times_taken(place(np.random.default_rng(seed), trials), 30.0, seed, sensors)
            shares = ", ".join(f"{np.mean(taken <= s):.2f}" for s in (10.0, 20.0, 30.0))
            say(f"{noise_m:g} m, {place.__name__}: {shares} within 10, 20, 30 s")


if __name__ == "__main__":
    main()
