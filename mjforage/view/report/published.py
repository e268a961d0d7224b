"""Figures printed in the paper, for comparison, and what its public code gives beside them.

Paper: A. Mendoza Barrionuevo, S. Yanes Luis, D. Gutierrez Reina and S. L. Toral Marin, "Beyond
Task Performance: A Metric-Based Analysis of Sequential Cooperation in Heterogeneous Multi-Agent
Destructive Foraging". `printed` numbers are its tables of PTA and RMSE, of NT and throughput, and
of CSR (here Tables 2, 3 and 4), `slopes`, `ablated` and `contribution` those of slopes, ablations
and contributions (here 4, 5 and 6), all of one seed of 100 episodes. `pooled` numbers are not in
the paper but come from running its public code (github.com/amendb/CollaborationMetrics) on its map,
over many seeds: hold a run against these.

That code draws Lévy lengths and never uses them: its Lévy rows are those of a straight walk that
only obstacles turn, here the policy `wanderer`. `levy` walks true Lévy lengths.
"""

from dataclasses import dataclass, field, replace

from mjforage.runs.run_info import RunInfo
from mjforage.scenario.harbours import is_harbour
from mjforage.scenario.map_files import is_shipped_map
from mjforage.scenario.scenario_file import load_scenario, scenario_to_tree

ELSEWHERE = " (its own map)"
ITS_CODE = "its public code{}, 1,300 episodes"
STRAIGHT = "Lévy walks, walked straight"
STRAIGHT_NOTE = (
    "The paper's code draws Lévy lengths and never uses them: its Lévy rows are those of a "
    "straight walk, wanderer here; levy walks true Lévy lengths."
)
SCENARIOS = frozenset({"published", "comb-port"})
NODES = 1297  # of the paper's map


@dataclass(frozen=True)
class Pooled:
    """What the public code gives over many seeds: metric key to mean, and to half of the 95 %
    interval where it was told.
    """

    what: str  # was run: head of a row, with {} where `elsewhere` belongs
    mean: dict[str, float] = field(default_factory=dict)
    interval: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Published:
    """One algorithm of the paper: metric key to mean, and to 1.96 SEM where printed."""

    algorithm: str
    printed: dict[str, float]
    interval: dict[str, float]  # 1.96 SEM
    pooled: Pooled | None = None
    slopes: dict[tuple[str, str], float] = field(default_factory=dict)
    """(corrupted team, metric): Sensitivity Slope."""
    ablated: dict[str, dict[str, float]] = field(default_factory=dict)
    """Team with an agent less: metric to mean (its table has PTA_D and PTA_C exchanged)."""
    contribution: dict[str, dict[str, float]] = field(default_factory=dict)
    """The same: metric to Marginal Contribution."""

    @property
    def whole_fleet(self) -> tuple[dict[str, float], dict[str, float]]:
        """Means and half intervals that the whole fleet is held against: pooled, else printed."""
        if self.pooled is None:
            return self.printed, self.interval
        return self.pooled.mean, self.pooled.interval


def _slopes(scouts: float, foragers: float) -> dict[tuple[str, str], float]:
    return {("scouts", "pta_c"): scouts, ("foragers", "rmse_columns"): foragers}


def _by_team(
    scouts: tuple[float, float, float], foragers: tuple[float, float, float]
) -> dict[str, dict[str, float]]:
    keys = ("pta_d", "pta_c", "rmse_columns")
    return {
        "scouts": dict(zip(keys, scouts, strict=True)),
        "foragers": dict(zip(keys, foragers, strict=True)),
    }


_STRAIGHT = Published(
    STRAIGHT,
    {
        "pta_d": 82.28,
        "pta_c": 80.43,
        "rmse_columns": 0.0165,
        "nt50": 0.477,
        "nt90": 0.735,
        "throughput": 0.199,
        "csr": 0.686,
    },
    {"pta_d": 5.93, "pta_c": 5.98, "rmse_columns": 0.0051},
    Pooled(
        f"{STRAIGHT}, {ITS_CODE}",
        {
            "pta_d": 82.02,
            "pta_c": 79.08,
            "rmse": 0.0522,
            "rmse_columns": 0.0168,
            "nt50": 0.473,
            "nt90": 0.731,
            "throughput": 0.1969,
            "csr": 0.724,
            "mi_final": 0.444,
            "itl": 0.138,
            "dsl": 0.1459,
            "gini_foragers": 0.196,
            "co_scouts": 0.033,
            "length": 140.7,
        },
        {"pta_d": 1.67, "pta_c": 1.73},
    ),
    _slopes(-20.86, 0.0205),
    _by_team((76.17, 72.50, 0.0223), (78.60, 73.85, 0.0202)),
    _by_team((0.0743, 0.0986, 0.2601), (0.0447, 0.0818, 0.1832)),
)

PAPER: dict[str, Published] = {
    "ddqn-reward": Published(
        "DRL",
        {
            "pta_d": 99.41,
            "pta_c": 98.68,
            "rmse_columns": 0.0010,
            "nt50": 0.281,
            "nt90": 0.512,
            "throughput": 0.245,
            "csr": 0.946,
        },
        {"pta_d": 0.46, "pta_c": 0.56, "rmse_columns": 0.0005},
        slopes=_slopes(-40.55, 0.0061),
        ablated=_by_team((93.55, 87.92, 0.0077), (99.32, 95.14, 0.0017)),
        contribution=_by_team((0.0589, 0.1090, 0.8701), (0.0009, 0.0359, 0.4118)),
    ),
    "greedy": Published(
        "Greedy",
        {
            "pta_d": 98.85,
            "pta_c": 98.20,
            "rmse_columns": 0.0017,
            "nt50": 0.349,
            "nt90": 0.583,
            "throughput": 0.244,
            "csr": 0.899,
        },
        {"pta_d": 1.04, "pta_c": 1.15, "rmse_columns": 0.0012},
        Pooled(
            f"Greedy, {ITS_CODE}",
            {
                "pta_d": 98.56,
                "pta_c": 97.20,
                "rmse": 0.0069,
                "rmse_columns": 0.0018,
                "nt50": 0.344,
                "nt90": 0.591,
                "throughput": 0.2431,
                "csr": 0.908,
                "mi_final": 0.381,
                "itl": 0.189,
                "dsl": 0.2088,
                "gini_foragers": 0.146,
                "co_scouts": 0.060,
                "length": 123.9,
            },
            {"pta_d": 0.40, "pta_c": 0.51, "rmse": 0.0014},
        ),
        _slopes(-45.14, 0.0104),
        _by_team((88.08, 82.26, 0.0130), (98.70, 94.89, 0.0029)),
        _by_team((0.1090, 0.1623, 0.8692), (0.0015, 0.0337, 0.4138)),
    ),
    "levy": replace(
        _STRAIGHT,
        pooled=Pooled(
            "Lévy walks, its public code with lengths kept{}, 600 episodes",
            {"pta_d": 82.5, "pta_c": 80.0, "rmse_columns": 0.0159},
            {"pta_d": 2.4, "pta_c": 2.5},
        ),
    ),
    "wanderer": _STRAIGHT,
}
"""Our policy name to the paper's algorithm: its like. The paper's network learnt from reward, as
`ddqn-reward`; `ddqn` was taught by the planner.
"""

TAUGHT = frozenset({"ddqn", "ddqn-link"})
"""Policies that ship to which the belief planner showed moves in training."""

NUMBERS = {
    **{f"table-{number}": f"Table {number}" for number in (2, 3, 4, 5, 6)},
    "contribution-graph": "Table 6",
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
"""Our table or figure to the paper's of the same quantity."""

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
    """What a label says where the paper's map is another than the run's: ours.

    Nothing on a user's map: it may be the paper's, which is not ours to ship, so nobody knows.
    """
    name = run.map.name
    return ELSEWHERE if is_shipped_map(name) or is_harbour(name) else ""


def comparable(run: RunInfo) -> bool:
    """Whether a run is of a shipped scenario with the paper's fleet, on a map of the paper's size.

    Nothing but the map's file may be changed.
    """
    if run.name not in SCENARIOS or run.map.nodes != NODES:
        return False
    mission, shipped = dict(run.scenario), scenario_to_tree(load_scenario(run.name))
    mission["map"] = dict(mission["map"]) | {"file": shipped["map"]["file"]}
    return bool(mission == shipped)
