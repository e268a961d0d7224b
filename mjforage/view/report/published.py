"""Figures printed in the paper, for comparison, and what its public code gives beside them.

Paper: A. Mendoza Barrionuevo, S. Yanes Luis, D. Gutierrez Reina and S. L. Toral Marin, "Beyond
Task Performance: A Metric-Based Analysis of Sequential Cooperation in Heterogeneous Multi-Agent
Destructive Foraging". `printed` numbers are its tables of PTA and RMSE, of NT and throughput, and
of CSR (here Tables 2, 3 and 4), `slopes`, `ablated` and `contribution` those of slopes, ablations
and contributions (here 4, 5 and 6); `measured` ones are not in the paper but come from running its
public code (github.com/amendb/CollaborationMetrics) on its 100 evaluation episodes.
"""

from dataclasses import dataclass, field

from mjforage.core.scenario_file import load_scenario, scenario_to_tree
from mjforage.runs.run_info import RunInfo

LABEL = "paper (its own map)"
SCENARIOS = frozenset({"published", "comb-port"})
NODES = 1297  # of the paper's map


@dataclass(frozen=True)
class Published:
    """One algorithm of the paper: metric key to mean, and to 1.96 SEM where printed."""

    algorithm: str
    printed: dict[str, float]
    interval: dict[str, float]  # 1.96 SEM
    measured: dict[str, float] = field(default_factory=dict)
    slopes: dict[tuple[str, str], float] = field(default_factory=dict)
    """(corrupted team, metric): Sensitivity Slope."""
    ablated: dict[str, dict[str, float]] = field(default_factory=dict)
    """Team with an agent less: metric to mean (its table has PTA_D and PTA_C exchanged)."""
    contribution: dict[str, dict[str, float]] = field(default_factory=dict)
    """The same: metric to Marginal Contribution."""


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


PAPER: dict[str, Published] = {
    "ddqn": Published(
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
        {"rmse": 0.0063},
        _slopes(-45.14, 0.0104),
        _by_team((88.08, 82.26, 0.0130), (98.70, 94.89, 0.0029)),
        _by_team((0.1090, 0.1623, 0.8692), (0.0015, 0.0337, 0.4138)),
    ),
    "levy": Published(
        "Lévy walks",
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
        {"rmse": 0.0514},
        _slopes(-20.86, 0.0205),
        _by_team((76.17, 72.50, 0.0223), (78.60, 73.85, 0.0202)),
        _by_team((0.0743, 0.0986, 0.2601), (0.0447, 0.0818, 0.1832)),
    ),
}
"""Our policy name to the paper's algorithm."""


def published_for(run: RunInfo, policy: str) -> Published | None:
    """Return the paper's figures for a policy, where the run is one they can stand beside."""
    return PAPER.get(policy) if comparable(run) else None


def comparable(run: RunInfo) -> bool:
    """Whether a run is of a shipped scenario with the paper's fleet, on a map of the paper's size.

    Nothing but the map's file may be changed.
    """
    if run.name not in SCENARIOS or run.map.nodes != NODES:
        return False
    mission, shipped = dict(run.scenario), scenario_to_tree(load_scenario(run.name))
    mission["map"] = dict(mission["map"]) | {"file": shipped["map"]["file"]}
    return bool(mission == shipped)
