"""How the hulls did: outcomes of moves, speeds, touches and energy, from `agents.parquet`."""

import math
from collections.abc import Iterator, Mapping

import polars as pl

from graph_planner.navigation import STAY
from mjforage.core.dynamics import ARRIVED, BLOCKED, OUTCOMES
from mjforage.view.page.table import Number, Row, Table
from mjforage.view.report.run_logs import RunLogs, read_columns
from mjforage.view.report.text_tables import head_of, number

COLUMNS = (
    *("step", "agent", "direction", "outcome", "speed_mps"),
    *("collisions", "impact_mps", "work_j"),
)


SHOWN = (
    *(("moves", ""), ("arrived", "%"), ("late", "%"), ("blocked", "%"), ("stays", "")),
    *(("kept", "%"), ("speed", "m/s"), ("touches", "per episode"), ("fastest touch", "m/s")),
    *(("energy", "kJ per episode"), ("energy", "kJ per item")),
)
"""Column -> unit, in the order of `_figures`."""
DIGITS = (0, 2, 2, 2, 0, 2, 2, 2, 2, 1, 2)
NOTE = (
    "Arrived: midships came within 1 m of the target's centre during the decision; blocked: "
    "slower than 0.1 m/s for 2 s because of contact or giving way, or no legal move; late: "
    "neither. Stays: decisions to stay put; kept: within 1 m of the centre at some time of "
    "the decision. Speed: mean over the decisions with any way made. Touch: of a quay or "
    "another hull. Energy: drawn from the batteries by thrusters and all else on board."
)


def _figures(rows: pl.DataFrame, collected: float) -> tuple[float, ...]:
    """Numbers of one world, policy and team.

    Parameters
    ----------
    rows : of the decisions made (step 1 on)
    collected : items removed in all episodes
    """
    stays = (pl.col("direction") == STAY) & (pl.col("outcome") != OUTCOMES[BLOCKED])
    moves, kept = rows.filter(~stays), rows.filter(stays)
    shares = [_share(moves, pl.col("outcome") == name) for name in OUTCOMES]
    moving = rows.filter(pl.col("speed_mps") > 0)["speed_mps"]
    last = rows.filter(pl.col("step") == pl.col("step").max().over("episode", "agent"))
    episodes = max(1, rows["episode"].n_unique())
    work = float(last["work_j"].sum())
    speed = moving.mean()
    impact = rows["impact_mps"].max()
    return (
        len(moves),
        *shares,
        len(kept),
        _share(kept, pl.col("outcome") == OUTCOMES[ARRIVED]),
        float(speed) if isinstance(speed, float) else math.nan,
        float(last["collisions"].sum()) / episodes,
        float(impact) if isinstance(impact, float) else math.nan,
        work / episodes / 1000,
        work / collected / 1000 if collected else math.nan,
    )


def _share(rows: pl.DataFrame, wanted: pl.Expr) -> float:
    """Percentage of the rows; NaN without any."""
    return 100 * len(rows.filter(wanted)) / len(rows) if len(rows) else math.nan


def hulls_table(runs: Mapping[str, RunLogs], episodes: int | None = None) -> Table | None:
    """Outcomes, speeds, touches and energy of every team; None for runs at graph level only.

    Parameters
    ----------
    runs : what stands before the policies -> run
    episodes : how many of each run's; all if None
    """
    rows = [row for name, logs in runs.items() for row in _rows(name, logs, episodes)]
    if not rows:
        return None
    labels, units = zip(*SHOWN, strict=True)
    return Table("hulls", "How the hulls did", labels, tuple(rows), (NOTE,), units, head="team")


def _rows(name: str, logs: RunLogs, episodes: int | None) -> Iterator[Row]:
    worlds = [world for world in logs.run.worlds if world != "graph"]
    if not worlds or not logs.run.agents:
        return
    count = pl.col("episode") < (logs.run.episodes if episodes is None else episodes)
    frame = read_columns(logs.folder / "agents.parquet", COLUMNS)
    frame = frame.filter(pl.col("step") > 0)
    teams = list(dict.fromkeys(agent.team for agent in logs.run.agents))
    for policy in logs.policies:
        for world in worlds:
            series = (world, policy)
            mine = logs.select(frame, series).filter(count)
            items = logs.select(logs.items, series).filter(count)
            collected = float(items["t_collected"].drop_nulls().len())
            group = ": ".join(filter(None, (name, head_of(logs, series))))
            for team in teams:
                numbers = [i for i, agent in enumerate(logs.run.agents) if agent.team == team]
                found = _figures(mine.filter(pl.col("agent").is_in(numbers)), collected)
                cells = tuple(map(number, found, DIGITS))
                yield Row(team, cells, group=group, values=tuple(map(Number, found)))
