"""Courses of metrics over the episodes, from a table that may be far larger than the memory."""

from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.runs.parquet import collected, read_schema, scan_parquet
from mjforage.runs.run_info import REMEDY, RunInfo

KEYS = ("world", "policy", "episode")
STEP = ("world", "policy", "step")
POINTS = 400  # steps of a course that are drawn beside the first, where the horizon has more
BLOCK = 250_000  # rows that are held at once
STD, COUNT = "/std", "/n"  # endings of columns beside that of the mean


def drawn_steps(horizon: int) -> NDArray[np.int64]:
    """Steps from 0 to the horizon at which courses are drawn, evenly apart."""
    even = np.linspace(0, horizon, min(horizon, POINTS) + 1)
    return np.rint(even).astype(np.int64)


def metrics_in(path: Path) -> tuple[str, ...]:
    """Columns of metrics of a table of steps, in its order.

    Raises
    ------
    UserError
        If the file is missing or truncated, lacks a column, or has one of words.
    """
    numbers(path, scan_parquet(path, (*KEYS, "step"), REMEDY))
    numbers(path, scan_parquet(path, None, REMEDY))
    return tuple(name for name in read_schema(path, REMEDY) if name not in (*KEYS, "step"))


def numbers(path: Path, frame: pl.LazyFrame) -> pl.LazyFrame:
    """All columns but the keys as float64, with null for undefined.

    Raises
    ------
    UserError
        If one is of words.
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
    standard deviation (`STD`) and one with their number (`COUNT`). Rows are read block by block.

    Raises
    ------
    UserError
        As `metrics_in`, and if the file is damaged inside.
    """
    keys, frame = metrics_in(path), numbers(path, scan_parquet(path, None, REMEDY))
    height = int(collected(path, frame.select(pl.len()), REMEDY).item())
    wanted = (
        pl.col("policy").is_in(run.policies),
        pl.col("step").is_in(drawn_steps(run.horizon).astype(np.float64)),
    )
    parts = []
    for first in range(0, max(height, 1), BLOCK):
        rows = collected(path, frame.slice(first, BLOCK).filter(*wanted), REMEDY)
        parts.append(rows.group_by(*STEP, maintain_order=True).agg(*_moments(keys)))
    return (parts[0] if len(parts) == 1 else _merged(pl.concat(parts), keys)).sort(*STEP)


def _moments(keys: tuple[str, ...]) -> list[pl.Expr]:
    return [
        part
        for key in keys
        for part in (
            pl.col(key).mean(),
            pl.col(key).std(ddof=1).alias(key + STD),
            pl.col(key).count().cast(pl.Int64).alias(key + COUNT),
        )
    ]


def _merged(parts: pl.DataFrame, keys: tuple[str, ...]) -> pl.DataFrame:
    """Of rows of the same world, policy and step one, as if their episodes had come together."""
    merged = []
    for key in keys:
        n, mean = pl.col(key + COUNT), pl.col(key)
        total, whole = n.sum(), (mean * n).sum() / n.sum()
        apart = (pl.col(key + STD).fill_null(0.0) ** 2 * (n - 1).clip(0)).sum()
        apart = apart + (n * (mean - whole) ** 2).sum()
        several = pl.when(total > 1)
        merged += [
            pl.when(total > 0).then(whole).alias(key),
            several.then((apart / (total - 1)).sqrt()).alias(key + STD),
            total.alias(key + COUNT),
        ]
    return parts.group_by(*STEP, maintain_order=True).agg(*merged)
