"""Episode logs as the tables of a run folder (columns: docs/run-folder.md)."""

from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.forcing.record import begins_of
from mjforage.forcing.record_files import utc
from mjforage.mission.dynamics import OUTCOMES
from mjforage.mission.episode_log import EpisodeLog
from mjforage.mission.scoring import Scores
from mjforage.mission.setup import Setup
from mjforage.mission.task import PICKUPS
from mjforage.physics.worlds import forcing_of
from mjforage.runs.parquet import read_parquet, read_schema, spoilt
from mjforage.scenario.bearings import bearing_of
from mjforage.scenario.place import Place, north_deg

Columns = dict[str, NDArray[Any] | pl.Series]
TABLES = ("episodes", "steps", "items", "agents")
KEYS = {"world": pl.String, "policy": pl.String, "episode": pl.Int64}
SCHEMAS: dict[str, dict[str, type[pl.DataType]]] = {
    "episodes": KEYS | {"items": pl.Int64},
    "steps": KEYS
    | {"step": pl.Int32}
    | dict.fromkeys(
        ("wind_speed_mps", "wind_from_deg", "current_speed_mps", "current_to_deg"), pl.Float32
    ),
    "items": KEYS
    | {"item": pl.Int32, "row_start": pl.Float32, "col_start": pl.Float32}
    | dict.fromkeys(("t_discovered", "discovered_by", "t_collected", "collected_by"), pl.Int32),
    "agents": KEYS
    | dict.fromkeys(("step", "agent", "node", "row", "col"), pl.Int32)
    | {"direction": pl.Int8, "target": pl.Int32}
    | dict.fromkeys(("x_m", "y_m", "yaw_rad", "speed_mps"), pl.Float32)
    | {"outcome": pl.String, "pickup": pl.String, "distance_m": pl.Float32, "energy": pl.Float32}
    | {"collisions": pl.Int32, "impact_mps": pl.Float32, "work_j": pl.Float32},
}
"""Table -> column -> type, in order; in those of `METRIC_COLUMNS` metrics come after."""
ON_A_PLACE: dict[str, dict[str, type[pl.DataType]]] = {
    "items": dict.fromkeys(("lat_start_deg", "lon_start_deg"), pl.Float64),
    "agents": dict.fromkeys(("lat_deg", "lon_deg"), pl.Float64),
}
"""Table -> columns that it has besides where the map is a place."""
WITH_A_RECORD: dict[str, dict[str, type[pl.DataType]]] = {"episodes": {"record_start": pl.String}}
"""The same where the weather is recorded."""
_SOMETIMES = ON_A_PLACE | WITH_A_RECORD
METRIC_COLUMNS: dict[str, type[pl.DataType]] = {"episodes": pl.Float64, "steps": pl.Float32}
"""Table -> type of its columns of metrics: those that the run was made with, whichever they are."""


def _frame(table: str, world: str, policy: str, columns: Columns) -> pl.DataFrame:
    frame = pl.DataFrame(columns).with_columns(
        world=pl.lit(world, pl.String), policy=pl.lit(policy, pl.String)
    )
    schema = dict(SCHEMAS[table])
    if _SOMETIMES.get(table, {}).keys() & set(frame.columns):
        schema |= _SOMETIMES[table]
    if table in METRIC_COLUMNS:
        schema = schema | dict.fromkeys(metric_columns(frame, table), METRIC_COLUMNS[table])
    return frame.select(pl.col(name).cast(kind) for name, kind in schema.items())


def metric_columns(frame: pl.DataFrame, table: str = "episodes") -> list[str]:
    """Columns of metrics that a table has, in its order."""
    others = SCHEMAS[table] | _SOMETIMES.get(table, {})
    return [name for name in frame.columns if name not in others]


def _episodes(
    setup: Setup, episodes: NDArray[np.int64], log: EpisodeLog, scores: Scores
) -> Columns:
    columns: Columns = {"episode": episodes, "items": log.n_items}
    begins = begins_of(setup.scenario, log.keys)
    if begins is not None:
        columns["record_start"] = pl.Series([utc(seconds) for seconds in begins])
    return columns | scores.scalars


def _steps(
    setup: Setup, world: str, episodes: NDArray[np.int64], log: EpisodeLog, scores: Scores
) -> Columns:
    steps, north = setup.scenario.horizon + 1, north_deg(setup.grid.place)
    forcing = forcing_of(setup, world, log.keys)
    times_s = setup.scenario.period_s * np.arange(steps)
    moments = [forcing.open_water(time_s, gusts=False) for time_s in times_s.tolist()]
    wind, current = (np.stack(each, axis=1).reshape(-1, 2) for each in zip(*moments, strict=True))
    columns: Columns = {
        "episode": np.repeat(episodes, steps),
        "step": np.tile(np.arange(steps), episodes.size),
        "wind_speed_mps": np.hypot(*wind.T),
        "wind_from_deg": pl.Series(bearing_of(-wind, north), nan_to_null=True),
        "current_speed_mps": np.hypot(*current.T),
        "current_to_deg": pl.Series(bearing_of(current, north), nan_to_null=True),
    }
    return columns | {key: values.ravel() for key, values in scores.series.items()}


def _items(episodes: NDArray[np.int64], log: EpisodeLog, place: Place | None) -> Columns:
    shape = log.t_discovered.shape
    exists = np.arange(shape[1])[None, :] < log.n_items[:, None]
    columns: Columns = {
        "episode": np.broadcast_to(episodes[:, None], shape)[exists],
        "item": np.broadcast_to(np.arange(shape[1]), shape)[exists],
        "row_start": log.item_start[exists, 0],
        "col_start": log.item_start[exists, 1],
    }
    if place:
        latlon = place.latlon(log.item_start[exists])
        columns |= {"lat_start_deg": latlon[:, 0], "lon_start_deg": latlon[:, 1]}
    for name in ("t_discovered", "discovered_by", "t_collected", "collected_by"):
        values = getattr(log, name)[exists].astype(np.int32)
        series = pl.Series(values)
        columns[name] = series.set(series < 0, None)
    return columns


def _agents(episodes: NDArray[np.int64], log: EpisodeLog, setup: Setup) -> Columns:
    shape, graph = log.agent_node.shape, setup.graph
    pitch_m, period_s = setup.scenario.map.pitch_m, setup.scenario.period_s
    made = np.broadcast_to(np.arange(shape[1])[None, :, None] <= log.length[:, None, None], shape)
    node, xy = log.agent_node[made], graph.metres(log.agent_rc[made])
    step = np.broadcast_to(np.arange(shape[1])[None, :, None], shape)[made]
    names = np.array(("start", *OUTCOMES))
    direction = pl.Series(log.direction[made])
    columns: Columns = {}
    if setup.grid.place:
        latlon = setup.grid.place.latlon(log.agent_rc[made])
        columns = {"lat_deg": latlon[:, 0], "lon_deg": latlon[:, 1]}
    return columns | {
        "episode": np.broadcast_to(episodes[:, None, None], shape)[made],
        "step": step,
        "agent": np.broadcast_to(np.arange(shape[2]), shape)[made],
        "node": node,
        "row": graph.rows[node],
        "col": graph.cols[node],
        "direction": direction.set(direction < 0, None),
        "target": log.target[made],
        "x_m": xy[:, 0],
        "y_m": xy[:, 1],
        "yaw_rad": log.yaw[made],
        "speed_mps": log.speed[made] * (pitch_m / period_s),
        "outcome": names[np.where(step == 0, 0, log.outcome[made] + 1)],
        "pickup": np.array(PICKUPS)[log.pickup[made]],
        "distance_m": log.distance[made] * pitch_m,
        "energy": log.energy[made],
        "collisions": log.collisions[made],
        "impact_mps": log.impact[made],
        "work_j": log.work[made],
    }


def frames(
    setup: Setup,
    world: str,
    policy: str,
    episodes: NDArray[np.int64],
    log: EpisodeLog,
    scores: Scores,
) -> dict[str, pl.DataFrame]:
    """The four tables of a finished batch, by name.

    Parameters
    ----------
    setup : scenario and map
    world, policy : names, written into every row
    episodes : (episode,) numbers of the batch's episodes
    log, scores : the batch
    """
    columns: dict[str, Columns] = {
        "episodes": _episodes(setup, episodes, log, scores),
        "steps": _steps(setup, world, episodes, log, scores),
        "items": _items(episodes, log, setup.grid.place),
        "agents": _agents(episodes, log, setup),
    }
    return {name: _frame(name, world, policy, columns[name]) for name in TABLES}


def check_table(path: Path, table: str, remedy: str = "") -> None:
    """Check that a file is a table of this package, by its schema.

    Raises `UserError` if the file is missing, truncated, not Parquet or has other columns.

    Parameters
    ----------
    path : Parquet file
    table : one of `TABLES`
    remedy : last words of the message; to move the file away and compute it again if empty
    """
    schema = read_schema(path, remedy)
    wrong = {name for name, kind in SCHEMAS[table].items() if schema.get(name) != kind}
    metrics, known = METRIC_COLUMNS.get(table), _SOMETIMES.get(table, {})
    more = set(schema) - set(SCHEMAS[table])
    wrong |= {name for name in more if schema[name] not in (metrics, known.get(name))}
    if wrong:
        names = ", ".join(sorted(wrong))
        raise UserError(
            f"{path}: not a table of {table} ({names} differ); {remedy or spoilt(path)}"
        )


def read_table(path: Path, table: str, remedy: str = "") -> pl.DataFrame:
    """Check and read a table; parameters as for `check_table`.

    Raises `UserError` as `check_table`, and if the file is damaged inside.
    """
    check_table(path, table, remedy)
    return read_parquet(path, remedy=remedy)
