"""Small scenarios of all kinds, for hypothesis."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import ndimage

from mjforage.graph_planner.graph.walls import WALLS
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario_file import load_scenario

TEAMS: dict[str, Any] = {
    "team.scouts.count": (0, 1, 2, 3),
    "team.scouts.moves": (1, 2, 3),
    "team.scouts.radius": (1.0, 2.5, 4.0),
    "team.scouts.energy": (0.0, 9.0),
    "team.foragers.count": (0, 1, 2, 3),
    "team.foragers.radius": (0.0, 1.0, 2.0),
    "team.foragers.capacity": (0, 1),
    "team.foragers.energy": (0.0, 6.0),
    "rules.stay": (True, False),
    "rules.shorten": (True, False),
    "rules.jump": (True, False),
    "rules.start_seen": (True, False),
    "rules.sight": ("line", "disc"),
    "rules.walls": WALLS,
    "rules.order": ([], ["scouts", "foragers"]),
}
WORLD: dict[str, Any] = {
    "items.mean": (2.0, 8.0, 25.0),
    "items.hotspots": (1, 3),
    "map.corner_cutting": (True, False),
    "map.pitch_m": (2.0, 4.0),
    "period_s": (10.0, 20.0),
    "weather.drift_node_per_step": (0.1, 0.6),
    "weather.noise_node_per_step": (0.0, 0.09),
}
WIND: dict[str, Any] = {
    "weather.wind_speed_mps": (2.0, 7.0),
    "weather.wind_from_deg": (0.0, 70.0, 200.0, None),
}
CORRUPTION: dict[str, Any] = {
    "corruption.team": ("scouts", "foragers"),
    "corruption.epsilon": (0.3, 1.0),
    "corruption.whole_team": (True, False),
}
SENSORS: dict[str, Any] = {
    "sensors.detection": (0.6, 0.9),
    "sensors.slope_node": (0.5, 1.0),
    "sensors.persistence": (0.0, 0.3),
    "sensors.false_rate": (0.0, 0.02, 0.2),
    "sensors.false_hold": (1, 3),
    "sensors.merge": (0.0, 0.5),
    "sensors.fov_deg": (360.0, 200.0, 90.0),
    "sensors.map": ("last", "filtered"),
}
FALLING: tuple[dict[str, Any], ...] = (
    {},
    {"sensors.half_range_node": 2.0},
    {"sensors.detection_table": [[0.0, 0.9], [2.0, 0.5]]},
    {"sensors.detection": 1.0, "sensors.persistence": 0.0, "sensors.merge": 0.3},
)
LINK: dict[str, Any] = {
    "link.model": ("none", "disk", "disk", "log-distance"),
    "link.range_m": (6.0, 15.0, 1000.0),
    "link.wall_db": (0.0, 10.0),
    "link.tx_dbm": (-10.0, 27.0),
    "link.shadowing_db": (0.0, 8.0),
    "link.loss": (0.0, 0.4),
    "link.burst": (1.0, 3.0),
    "link.latency": (0, 1, 4),
    "link.bytes": (0, 20),
    "link.cells": (0, 6),
    "link.relay": (True, False),
}


def written(key: str, value: Any) -> str:
    """An override."""
    text = str(value).lower() if isinstance(value, bool) else value
    return f"{key}={text}"


def ragged(seed: int, share: float) -> NDArray[np.bool_]:
    """The largest part of a random map."""
    rng = np.random.default_rng(seed)
    while True:
        label, parts = ndimage.label(rng.random(rng.integers(3, 9, 2)) < share)
        if parts:
            largest: NDArray[np.bool_] = label == np.bincount(label.ravel())[1:].argmax() + 1
            if largest.sum() >= 7:
                return largest


@dataclass(frozen=True)
class Drawn:
    """A scenario on a map of its own, as it is told when a test fails."""

    overrides: tuple[str, ...]
    map_seed: int
    share: float  # of water

    @property
    def setup(self) -> Setup:
        """The setup."""
        base = ("map.starts=[]", "items.std=2", "horizon=12")
        scenario = load_scenario("comb-port", [*base, *self.overrides])
        return Setup.of(scenario, ragged(self.map_seed, self.share))


@st.composite
def scenarios(draw: st.DrawFn) -> Drawn:
    """Scenarios of all kinds."""
    choices: dict[str, Any] = TEAMS | WORLD
    for part in (WIND, CORRUPTION, SENSORS, LINK):
        choices = choices | (part if draw(st.booleans()) else {})
    drawn: dict[str, Any] = {key: draw(st.sampled_from(values)) for key, values in choices.items()}
    if drawn["team.scouts.count"] + drawn["team.foragers.count"] == 0:
        drawn["team.scouts.count"] = 2
    drawn["rules.shorten"] &= not drawn["rules.jump"]
    drawn["rules.start_seen"] |= "link.model" in drawn
    if "sensors.detection" in drawn:
        drawn |= draw(st.sampled_from(FALLING))
    if "link.model" in drawn:
        drawn["team.scouts.relays"] = draw(st.booleans())
    given = tuple(written(*each) for each in drawn.items() if each[1] is not None)
    return Drawn(given, draw(st.integers(0, 999)), draw(st.sampled_from((0.6, 0.9))))
