"""Means of time series over the episodes, from a table that may be larger than the memory."""

from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.runs.parquet import collected, read_schema, scan_parquet
from mjforage.runs.run_info import REMEDY, RunInfo

KEYS = ("world", "policy", "episode")
STEP = ("world", "policy", "step")
BEARINGS = ("wind_from_deg", "current_to_deg")  # of which there are no means
POINTS = 400  # steps that are drawn beside the first, where the horizon has more
STD, COUNT = "/std", "/n"  # endings of columns beside that of the mean


def drawn_steps(horizon: int) -> NDArray[np.int64]:
    """Steps from 0 to the horizon at which time series are drawn, evenly apart."""
    even = np.linspace(0, horizon, min(horizon, POINTS) + 1)
    return np.rint(even).astype(np.int64)


def metrics_in(path: Path) -> tuple[str, ...]:
    """Columns of metrics of a table of steps, and of speeds of wind and current, in its order.

    Raises `UserError` if the file is missing or truncated, lacks a column, or has one of words.
    """
    numbers(path, scan_parquet(path, (*KEYS, "step"), REMEDY))
    numbers(path, scan_parquet(path, None, REMEDY))
    left = *KEYS, "step", *BEARINGS
    return tuple(name for name in read_schema(path, REMEDY) if name not in left)


def numbers(path: Path, frame: pl.LazyFrame) -> pl.LazyFrame:
    """All columns but the keys as float64, with null for undefined.

    Raises `UserError` if one is of words.
    """
    schema = frame.collect_schema()
    columns = [name for name in schema if name not in KEYS]
    for name in columns:
        if not schema[name].is_numeric():
            raise UserError(f"{path}: column '{name}' is {schema[name]}, not numeric; {REMEDY}")
    return frame.with_columns(pl.col(*columns).cast(pl.Float64).fill_nan(None))


def read_means(path: Path, run: RunInfo) -> pl.DataFrame:
    """A row per world, policy and step that is drawn, for the policies of a run.

    Of every metric a column with the mean of the episodes where it is defined, one with their
    standard deviation (`STD`) and one with their number (`COUNT`). The rows of one world and policy
    are held at once. Raises `UserError` as `metrics_in`, and if the file is damaged inside.
    """
    keys, frame = metrics_in(path), numbers(path, scan_parquet(path, None, REMEDY))
    drawn = pl.col("step").is_in(drawn_steps(run.horizon).astype(np.float64))
    moments = [
        part
        for key in keys
        for part in (
            pl.col(key).mean(),
            pl.col(key).std(ddof=1).alias(key + STD),
            pl.col(key).count().cast(pl.Int64).alias(key + COUNT),
        )
    ]
    parts = [
        collected(path, frame.filter(drawn, world=world, policy=policy), REMEDY)
        .group_by(*STEP, maintain_order=True)
        .agg(moments)
        for world in run.worlds
        for policy in run.policies
    ]
    return pl.concat(parts).sort(*STEP)
