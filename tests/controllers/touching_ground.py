"""Speeds of contacts where they are hard to avoid: `python -m tests.controllers.touching_ground`.

Crews drawn to one node of a small basin, foragers picking up items there that lie anywhere, at
quays and in corners too; gusts, 0.1 m and 1 degree of noise. A touch is that of a mission.
"""

import argparse
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mjforage.controllers import Pilot
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.physics.dynamics.collecting import MOUTH_DEPTH_M, MOUTH_REACH_M
from mjforage.physics.simulation import Simulation
from mjforage.physics.vessels import load_vessel
from mjforage.scenario.scenario import Weather
from tests.controllers.proving_ground import say
from tests.controllers.walks import PITCH_M, Outcome, Walk
from tests.graph_planner.charts import grid
from tests.mjforage.mission.by_hand import CALM

FloatArray = NDArray[np.float64]

EDGES_MPS = (0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.6, 10.0)
NOISE = (0.1, 0.0175)  # m, rad
REST_M = 1.9  # from the node's centre to an item, on each axis, at most
ITEM_SHARE = 0.7  # of decisions with an item in the node
BREEZE = replace(CALM, drift_node_per_step=0.04, gust_intensity=0.15)
STREAM = replace(
    CALM,
    drift_node_per_step=0.04,
    gust_intensity=0.15,
    current_speed_mps=0.3,
    current_to_deg=None,
)
BASIN, LANE, POOL = ("....", "....", "...."), ("........",), ("...", "...")
HARBOUR = ("......", ".##.#.", "......", ".#.##.", "......")


@dataclass(frozen=True)
class Place:
    """A basin, how many of each class are in it, and its weather."""

    rows: tuple[str, ...]
    scouts: int
    foragers: int
    weather: Weather = BREEZE


PLACES = {
    "two in a pool": Place(POOL, 1, 1),
    "two foragers": Place(POOL, 0, 2),
    "four in a lane": Place(LANE, 2, 2),
    "four in a basin": Place(BASIN, 2, 2),
    "eight": Place(HARBOUR, 4, 4),
    "sixteen": Place(HARBOUR, 8, 8),
    "current": Place(BASIN, 2, 2, STREAM),
}


class Items:
    """Items at rest in the nodes that foragers are sent to, until they are in the mouth."""

    def __init__(self, walk: Walk, scouts: int, seed: int) -> None:
        self._walk, self._scouts = walk, scouts
        self._rng, self._period = np.random.default_rng(seed), -1
        self._at = np.empty(0)

    def __call__(
        self, period: int, simulation: Simulation, pilot: Pilot, target: FloatArray
    ) -> None:
        """Draw the period's items at its first tick; name to the pilot those that are left."""
        if period != self._period:
            self._period = period
            self._at = target + self._rng.uniform(-REST_M, REST_M, target.shape)
            none = self._rng.random(target.shape[:2]) > ITEM_SHARE
            none[:, : self._scouts] = True
            self._at[none] = np.nan
        x, y, yaw = np.moveaxis(simulation.vessel_pose, -1, 0)
        dx, dy = self._at[..., 0] - x, self._at[..., 1] - y
        ahead = np.cos(yaw) * dx + np.sin(yaw) * dy - self._walk.size[:, 0]
        aside = np.abs(np.cos(yaw) * dy - np.sin(yaw) * dx)
        in_mouth = (ahead >= -MOUTH_DEPTH_M) & (ahead <= MOUTH_REACH_M)
        self._at[in_mouth & (aside <= self._walk.size[:, 1])] = np.nan
        pilot.collect(self._at)


def walked(place: Place, episodes: int, periods: int, seed: int) -> Outcome:
    """Send the crew of a place about, all to one node and then to another."""
    graph = navigation_graph(grid(*place.rows), PITCH_M, False)
    vessels = [load_vessel("scout")] * place.scouts + [load_vessel("forager")] * place.foragers
    cells = np.argwhere(graph.navigable)[: len(vessels)].tolist()
    walk = Walk(
        graph,
        vessels,
        [(row, column) for row, column in cells],
        scouts=place.scouts,
        episodes=episodes,
        weather=place.weather,
        noise=NOISE,
        seed=seed,
    )
    return walk.run(periods, crowded=True, record=Items(walk, place.scouts, seed))


def main() -> None:
    """Print how often vessels touched at which speed, and when they touched fastest."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--episodes", type=int, default=40)
    parser.add_argument("--periods", type=int, default=60)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--place", choices=PLACES, action="append")
    chosen = parser.parse_args()
    for name in chosen.place or PLACES:
        outcome = walked(PLACES[name], chosen.episodes, chosen.periods, chosen.seed)
        counts = np.histogram(outcome.speeds.clip(0.0), EDGES_MPS)[0].tolist()
        bins = zip(EDGES_MPS, EDGES_MPS[1:], counts, strict=False)
        told = ", ".join(f"{low:g}-{high:g}: {n}" for low, high, n in bins if n)
        arrived = 100.0 * outcome.arrived.sum() / outcome.moves.sum()
        say(f"{name}: {arrived:.1f} % arrived; touches by speed [m/s]: {told}")
        for period, episode, vessel, speed in sorted(outcome.impacts, key=lambda i: -i[3])[:3]:
            say(f"  {speed:.3f} m/s: episode {episode}, period {period}, vessel {vessel}")


if __name__ == "__main__":
    main()
