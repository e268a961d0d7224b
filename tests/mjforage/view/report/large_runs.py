"""Run folders far larger than usual: the rows of a small one under other names and numbers."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

from mjforage.runs.parquet import join_parquet
from mjforage.runs.tables import TABLES

BLOCK = 200  # copies written at once


def of_policies(folder: Path, count: int) -> Path:
    """The run with so many policies, each the first one with numbers a little worse than before."""
    run, summary = _read(folder, "run"), _read(folder, "summary")
    names, first = [f"policy-{i:04d}" for i in range(count)], run["policies"][0]
    for table in TABLES:
        path = folder / f"{table}.parquet"
        rows = pl.read_parquet(path).filter(pl.col("policy") == first)
        copies = (rows.with_columns(policy=pl.lit(name)) for name in names)
        if table == "episodes":
            worse = (100.0 * i / count for i in range(count))
            copies = (
                one.with_columns(pta_c=100.0 - by + pl.col("pta_c") / 1e3)
                for one, by in zip(copies, worse, strict=True)
            )
        pl.concat(list(copies)).write_parquet(path)
    for world, found in summary.items():
        summary[world] = {
            name: found[first]
            | {"pta_c": found[first]["pta_c"] | {"mean": 100.0 - 100 * i / count}}
            for i, name in enumerate(names)
        }
    _write(folder, "run", run | {"policies": names, "bounds": []})
    _write(folder, "summary", summary)
    return folder


def of_episodes(folder: Path, count: int) -> Path:
    """The run with so many episodes of every world and policy: a multiple of those it has."""
    run = _read(folder, "run")
    times = count // run["episodes"]
    for table in TABLES:
        _repeat(folder / f"{table}.parquet", times, run["episodes"])
    _write(folder, "run", run | {"episodes": times * run["episodes"]})
    return folder


def _repeat(path: Path, times: int, episodes: int) -> None:
    """Write all rows so many times, block by block, world and policy by world and policy."""
    parts: list[Path] = []
    for series in pl.read_parquet(path).partition_by("world", "policy", maintain_order=True):
        for first in range(0, times, BLOCK):
            numbers = pl.DataFrame({"copy": np.arange(first, min(times, first + BLOCK))})
            more = numbers.join(series, how="cross").with_columns(
                episode=pl.col("episode") + episodes * pl.col("copy")
            )
            parts.append(path.with_suffix(f".{len(parts)}"))
            more.select(series.columns).write_parquet(parts[-1])
    join_parquet(parts, path)
    for part in parts:
        part.unlink()


def _read(folder: Path, name: str) -> Any:
    return json.loads((folder / f"{name}.json").read_text())


def _write(folder: Path, name: str, content: object) -> None:
    (folder / f"{name}.json").write_text(json.dumps(content))
