"""A sea without symmetry, one item and a few agents on it: what happens can be told by hand."""

from pathlib import Path

import numpy as np

from mjforage.base.randomness import episode_keys
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario_file import load_scenario

ROWS, COLUMNS, PITCH_M, PERIOD_S = 24, 34, 5.0, 40.0
NAMES = ("N", "NE", "E", "SE", "S", "SW", "W", "NW", "stay")
TOWARD = dict(
    zip(NAMES, ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1)), strict=False)
)
"""Compass word -> nodes (to the east, to the north)."""
SEA = f"""
name = "hands"
horizon = 9
period_s = {PERIOD_S}
[map]
file = "sea.csv"
pitch_m = {PITCH_M}
starts = [[15, 8]]
[items]
mean = 1
std = 0
covariance_node2 = 0.0
[weather]
drift_node_per_step = 0.0
noise_node_per_step = 0.0
[team.pilots]
count = 1
moves = 1
radius = 3
collects = false
[team.skimmers]
count = 0
moves = 1
radius = 2
collects = true
"""


def sea(folder: Path, *overrides: str) -> Setup:
    """One pilot on an open sea, whose land is a hook in its north-east."""
    water = np.ones((ROWS, COLUMNS), np.int64)
    water[1, 28:33] = water[1:4, 32] = 0
    (folder / "sea.csv").write_text("\n".join(",".join(map(str, row)) for row in water))
    (folder / "hands.toml").write_text(SEA, "utf-8")
    return Setup.of(load_scenario(str(folder / "hands.toml"), overrides))


def amidst(setup: Setup) -> int:
    """First episode whose item starts in the middle of the sea, out of the pilot's way."""
    rc = setup.create_initial_state(episode_keys(0, np.arange(99))).item_rc[:, 0]
    clear = np.abs(rc - (12.0, 18.0)) < (4.5, 5.5)
    return int(np.flatnonzero(clear.all(axis=1))[0])


def told(mission: Mission, *words: str) -> None:
    """One decision, in which agent after agent, or each episode's only one, is told a word."""
    agents = mission.state.agent_node.shape
    wanted = np.array([NAMES.index(word) for word in words]).reshape(agents)
    mission.advance(np.eye(9)[wanted])
