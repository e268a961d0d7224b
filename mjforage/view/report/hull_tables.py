"""Performance of the hulls: outcomes of moves, speeds, contacts and energy, by team."""

import math
from collections.abc import Iterator

import polars as pl

from mjforage.graph_planner.graph.navigation import STAY
from mjforage.mission.dynamics import ARRIVED, BLOCKED, OUTCOMES
from mjforage.runs.parquet import collected, scan_parquet
from mjforage.runs.run_info import REMEDY
from mjforage.view.page.table import Row, Table
from mjforage.view.report.cells import number_cell, row
from mjforage.view.report.run_logs import Case, RunLogs
from mjforage.view.report.step_means import KEYS

COLUMNS = (
    *("step", "agent", "direction", "outcome", "speed_mps"),
    *("collisions", "impact_mps", "work_j"),
)
SHOWN = (
    *(("moves", "", 0), ("arrived", "%", 2), ("late", "%", 2), ("blocked", "%", 2)),
    *(("stays", "", 0), ("kept", "%", 2), ("speed", "m/s", 2), ("touches", "per episode", 2)),
    *(("fastest touch", "m/s", 2), ("energy", "kJ per episode", 1), ("energy", "kJ per item", 2)),
)
"""Column, unit and digits, in the order of `_figures`."""
NOTE = (
    "Arrived: midships came within 1 m of the target's centre during the decision; blocked: "
    "slower than 0.1 m/s for 2 s because of contact or giving way, or no legal move; late: "
    "neither. Stays: decisions to stay put; kept: within 1 m of the centre at some time of "
    "the decision. Speed: mean over the decisions with any way made. Touch: of a quay or "
    "another hull. Energy: drawn from the batteries by thrusters and all else on board."
)
_STAYS = (pl.col("direction") == STAY) & (pl.col("outcome") != OUTCOMES[BLOCKED])
_MOVING = pl.col("speed_mps") > 0
_SUMS: dict[str, pl.Expr] = {
    **{name: (~_STAYS & (pl.col("outcome") == name)).sum() for name in OUTCOMES},
    "moves": (~_STAYS).sum(),
    "stays": _STAYS.sum(),
    "kept": (_STAYS & (pl.col("outcome") == OUTCOMES[ARRIVED])).sum(),
    "moving": _MOVING.sum(),
    "speed": pl.col("speed_mps").cast(pl.Float64).filter(_MOVING).sum(),
    "touches": pl.col("collisions").max(),
    "work": pl.col("work_j").cast(pl.Float64).max(),
    "impact": pl.col("impact_mps").max().cast(pl.Float64),
}
"""Sums over the decisions of an agent in an episode, step 1 on; those of the last row rise."""


def _figures(team: pl.DataFrame, episodes: int, removed: float) -> tuple[float, ...]:
    """Numbers of one world, policy and team.

    Parameters
    ----------
    team : `_SUMS` of each of its agents in each episode
    removed : items that were, in all episodes
    """
    total = {name: float(team[name].sum()) for name in _SUMS}
    impact = team["impact"].drop_nulls().to_list()
    return (
        total["moves"],
        *(_share(total[name], total["moves"]) for name in OUTCOMES),
        total["stays"],
        _share(total["kept"], total["stays"]),
        total["speed"] / total["moving"] if total["moving"] else math.nan,
        total["touches"] / episodes,
        max(impact, default=math.nan),
        total["work"] / episodes / 1000,
        total["work"] / removed / 1000 if removed else math.nan,
    )


def _share(part: float, whole: float) -> float:
    """Percentage; NaN of nothing."""
    return 100 * part / whole if whole else math.nan


def hulls_table(logs: RunLogs) -> Table:
    """Outcomes, speeds, contacts and energy of every team; no rows for the graph world."""
    rows = tuple(row for case in logs.by_policy if case.world != "graph" for row in _rows(case))
    labels, units, _ = zip(*SHOWN, strict=True)
    title = "Performance of the hulls"
    return Table("hulls", title, labels, rows, (NOTE,), units, head="team")


def _rows(case: Case) -> Iterator[Row]:
    """A row per team of a world and policy."""
    path, episodes = case.logs.folder / "agents.parquet", case.logs.run.episodes
    removed = float(case.items()["t_collected"].drop_nulls().len())
    decisions = scan_parquet(path, (*KEYS, *COLUMNS), REMEDY).filter(
        pl.col("step") > 0, world=case.world, policy=case.policy
    )
    found = collected(path, decisions.group_by("episode", "agent").agg(**_SUMS), REMEDY)
    teams: dict[str, list[int]] = {}
    for i, agent in enumerate(case.logs.run.agents):
        teams.setdefault(agent.team, []).append(i)
    for team, own in teams.items():
        numbers = _figures(found.filter(pl.col("agent").is_in(own)), episodes, removed)
        cells = [number_cell(x, digits) for x, (*_, digits) in zip(numbers, SHOWN, strict=True)]
        yield row(team, cells, group=case.head)
