"""Logs are the same to the bit whatever runs beside them: chunks, workers, other policies."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import polars as pl
import pytest

from mjforage.runs import layout
from mjforage.runs.layout import plan
from mjforage.runs.tables import TABLES
from mjforage.runs.workers import Workers

Small = Callable[..., Path]


def tables(folder: Path, policy: str | None = None) -> dict[str, pl.DataFrame]:
    """The merged tables of a run, or one policy's rows of them."""
    frames = {table: pl.read_parquet(folder / f"{table}.parquet") for table in TABLES}
    if policy is None:
        return frames
    return {table: frame.filter(pl.col("policy") == policy) for table, frame in frames.items()}


def assert_bitwise_equal(one: dict[str, pl.DataFrame], other: dict[str, pl.DataFrame]) -> None:
    """Types, order and every bit (NaN included) are the same."""
    for table in TABLES:
        assert one[table].height > 0
        assert dict(one[table].schema) == dict(other[table].schema)
        for name in one[table].columns:
            a, b = one[table][name], other[table][name]
            assert a.null_count() == b.null_count()
            if a.dtype in (pl.Float32, pl.Float64):
                assert a.to_numpy().tobytes() == b.to_numpy().tobytes(), (table, name)
            else:
                assert a.equals(b), (table, name)


def test_bitwise_comparison_sees_the_smallest_difference(finished: Path) -> None:
    frames = tables(finished)
    column = frames["steps"]["mi"].to_numpy().copy()
    column[5] = math.nextafter(float(column[5]), 2.0) + 1e-7
    spoilt = frames | {"steps": frames["steps"].with_columns(mi=pl.Series(column))}
    with pytest.raises(AssertionError, match="mi"):
        assert_bitwise_equal(frames, spoilt)


UNEVEN: dict[str, Any] = {
    "episodes": 9,
    "horizon": 150,
    "overrides": [
        "items.mean=4",
        "items.std=1",
        "corruption.team=scouts",
        "corruption.epsilon=0.2",
    ],
}


@pytest.mark.parametrize("chunk", [1, 7, 25])
def test_logs_do_not_depend_on_the_chunk(
    chunk: int, evaluate_small: Small, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(layout, "CHUNK", 9)
    whole = evaluate_small(tmp_path / "whole", **UNEVEN)
    lengths = tables(whole)["episodes"]["length"].to_list()
    assert min(lengths) < 150 == max(lengths), "some episodes of a batch must end before others"
    monkeypatch.setattr(layout, "CHUNK", chunk)
    assert len(plan(["greedy"], ["graph"], 9)) == math.ceil(9 / chunk)
    parts = evaluate_small(tmp_path / "parts", **UNEVEN)
    assert_bitwise_equal(tables(whole), tables(parts))


def test_logs_do_not_depend_on_the_workers(
    evaluate_small: Small, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(layout, "CHUNK", 2)
    one = evaluate_small(tmp_path / "one", **UNEVEN)
    two = evaluate_small(tmp_path / "two", workers=Workers(2), **UNEVEN)
    assert_bitwise_equal(tables(one), tables(two))
    assert (one / "summary.json").read_bytes() == (two / "summary.json").read_bytes()


@pytest.mark.parametrize("policy", ["greedy", "levy", "random", "pso"])
def test_logs_do_not_depend_on_other_policies(
    policy: str, evaluate_small: Small, tmp_path: Path
) -> None:
    alone = evaluate_small(tmp_path / "alone", policies=[policy])
    others = [name for name in ("pso", "random", "greedy", "levy") if name != policy]
    beside = evaluate_small(tmp_path / "beside", policies=[*others[:2], policy, *others[2:]])
    assert_bitwise_equal(tables(alone), tables(beside, policy))
    pair = [json.loads((folder / "summary.json").read_text()) for folder in (alone, beside)]
    assert pair[0]["graph"][policy] == pair[1]["graph"][policy]


def test_more_episodes_leave_the_first_ones_as_they_are(
    finished: Path, evaluate_small: Small, tmp_path: Path
) -> None:
    more = tables(evaluate_small(tmp_path / "more", episodes=5))
    first = {table: frame.filter(pl.col("episode") < 3) for table, frame in more.items()}
    assert_bitwise_equal(tables(finished), first)
