"""Numbers printed in the paper, for comparison, and those of its public code.

Paper: A. Mendoza Barrionuevo, S. Yanes Luis, D. Gutierrez Reina and S. L. Toral Marin, "Beyond
Task Performance: A Metric-Based Analysis of Sequential Cooperation in Heterogeneous Multi-Agent
Destructive Foraging". `published.toml` has its numbers, and those of its public code
(github.com/amendb/CollaborationMetrics) on its map over many seeds: hold a run against the latter.
"""

import tomllib
from dataclasses import dataclass
from importlib import resources
from typing import Any

from mjforage.runs.run_info import RunInfo
from mjforage.scenario.harbours import is_harbour
from mjforage.scenario.map_files import is_shipped_map
from mjforage.scenario.scenario_file import load_scenario, scenario_to_tree

ELSEWHERE = " (its own map)"
STRAIGHT = "Lévy walks, walked straight"
STRAIGHT_NOTE = (
    "The paper's code draws Lévy lengths and never uses them: its Lévy rows are those of a "
    "straight walk, wanderer here; levy walks true Lévy lengths."
)
SCENARIOS = frozenset({"published", "comb-port"})
NODES = 1297  # of the paper's map
SLOPES = {"scouts": "pta_c", "foragers": "rmse_columns"}
"""Corrupted team -> metric whose Sensitivity Slope is printed."""
ABLATED = ("pta_d", "pta_c", "rmse_columns")
"""Metrics of a team with an agent less."""


@dataclass(frozen=True)
class Means:
    """Means by metric, and half of the 95 % interval of those of which it is known."""

    run: str  # head of a row, with {} where `elsewhere` belongs
    mean: dict[str, float]
    interval: dict[str, float]


@dataclass(frozen=True)
class Published:
    """One algorithm of the paper."""

    algorithm: str
    printed: Means
    pooled: Means | None  # of its public code
    slopes: dict[tuple[str, str], float]  # (corrupted team, metric) -> Sensitivity Slope
    ablated: dict[str, dict[str, float]]  # team with an agent less -> metric -> mean
    contribution: dict[str, dict[str, float]]  # the same -> Marginal Contribution

    @property
    def sources(self) -> list[Means]:
        """Means that the paper prints, and those of its public code."""
        return [self.printed, *([self.pooled] if self.pooled else [])]


def _published(data: dict[str, Any]) -> Published:
    teams = {
        name: {team: dict(zip(ABLATED, values, strict=True)) for team, values in data[name].items()}
        for name in ("ablated", "contribution")
    }
    return Published(
        data["algorithm"],
        Means(f"{data['algorithm']}, paper{{}}", data["printed"], data["interval"]),
        Means(**data["pooled"]) if "pooled" in data else None,
        {(team, SLOPES[team]): slope for team, slope in data["slopes"].items()},
        **teams,
    )


def _load() -> dict[str, Published]:
    file = resources.files("mjforage.view.report").joinpath("published.toml")
    data = tomllib.loads(file.read_text(encoding="utf-8"))
    return {name: _published(data.get(one.get("like"), {}) | one) for name, one in data.items()}


PAPER = _load()
"""Our policy -> the paper's algorithm that is its like."""

NUMBERS = {
    "scenario": "Figure 2",
    "pta": "Figure 4",
    "rmse": "Figure 5",
    "idleness": "Figure 6",
    "dsl": "Figure 7",
    "itl": "Figure 8",
    "csr": "Figure 9",
    "corruption-scouts": "Figure 10",
    "corruption-foragers": "Figure 11",
    "gini": "Figure 12",
    "overlap": "Figure 13",
}
"""Our figure -> the paper's of the same quantity."""

PLACES = {
    **dict.fromkeys(("pta_d", "pta_c", "rmse_columns"), "Table 2"),
    **dict.fromkeys(("nt50", "nt90", "throughput"), "Table 3"),
    "csr": "Table 4",
    "mi_final": "Figure 6",
    "dsl": "Figure 7",
    "itl": "Figure 8",
    "gini_foragers": "Figure 12",
    "co_scouts": "Figure 13",
}
"""Metric to where the paper shows it of the whole fleet."""


def published_for(run: RunInfo, policy: str) -> Published | None:
    """Return the paper's figures for a policy, where the run is one they can stand beside."""
    return PAPER.get(policy) if comparable(run) else None


def elsewhere(run: RunInfo) -> str:
    """Words of a label where the paper's map is another than the run's: ours.

    None on a user's map: it may be the paper's, which is not ours to ship.
    """
    name = run.map.name
    return ELSEWHERE if is_shipped_map(name) or is_harbour(name) else ""


def comparable(run: RunInfo) -> bool:
    """True if a run is of a shipped scenario with the paper's fleet and a map of the paper's size.

    Nothing but the map's file may be changed.
    """
    if run.name not in SCENARIOS or run.map.nodes != NODES:
        return False
    mission, shipped = dict(run.scenario), scenario_to_tree(load_scenario(run.name))
    mission["map"] = dict(mission["map"]) | {"file": shipped["map"]["file"]}
    return bool(mission == shipped)
