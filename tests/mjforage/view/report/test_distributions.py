"""Latencies of items and figures of episodes, on items and numbers written by hand."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from mjforage.view.page.figure import canvas, house_style
from mjforage.view.page.style import policy_styles
from mjforage.view.report.curves import time_series
from mjforage.view.report.distributions import distribution_figures, item_latencies
from mjforage.view.report.run_logs import Case, load_logs

ITEMS: dict[str, list[int | None]] = {  # discovered at, by; collected at, by: scouts are 0 and 1
    "t_discovered": [2, 1, 3, 4, 0],
    "discovered_by": [0, 1, 2, 0, 1],
    "t_collected": [8, 4, 5, None, 12],
    "collected_by": [2, 3, 2, None, 3],
}


@pytest.fixture
def folder(make_run: Callable[..., Path]) -> Path:
    """Ten episodes of two policies over 12 steps, of which greedy's first has those items."""
    folder = make_run(episodes=10, items=5)
    path = folder / "items.parquet"
    items = pl.read_parquet(path)
    mine = (pl.col("policy") == "greedy") & (pl.col("episode") == 0)
    first = items.filter(mine).sort("item")
    first = first.with_columns(*(pl.Series(key, x, pl.Int64) for key, x in ITEMS.items()))
    none = pl.lit(None, pl.Int64)
    others = items.filter(~mine).with_columns(none.alias(key) for key in ITEMS)
    pl.concat([first, others.select(first.columns)]).write_parquet(path)
    return folder


def test_latencies_are_of_what_scouts_found_and_foragers_took(folder: Path) -> None:
    """6, 3 and 12 of 12 steps; what a forager found and what stayed are left out."""
    logs = load_logs(folder)
    assert item_latencies(Case(logs, "graph", "greedy")).tolist() == [0.5, 0.25, 1.0]
    assert item_latencies(Case(logs, "graph", "levy")).size == 0


def test_boxes_of_a_figure_are_quartiles_of_their_policy(folder: Path) -> None:
    """Greedy: .5, .25 and 1, quartiles .375 and .75 about .5. Levy has no latency."""
    with house_style():
        latency = distribution_figures(load_logs(folder))[0]
    axes = latency.figure.axes[0]
    (greedy, *others) = [np.asarray(box.get_path().vertices) for box in axes.patches]
    assert (greedy[:, 1].min(), greedy[:, 1].max()) == (0.375, 0.75)
    assert all(np.isnan(one[:, 1]).all() for one in others)
    assert [0.5, 0.5] in [np.ravel(line.get_ydata()).tolist() for line in axes.lines]
    assert axes.get_ylabel() == "DSL"


def test_courses_have_their_means_and_bands_over_parts_of_the_horizon(folder: Path) -> None:
    """Ten episodes, five of 1 and five of 7: mean 4, SEM 1; undefined ones are left out."""
    path = folder / "steps.parquet"
    value = pl.when(pl.col("episode") % 2 == 0).then(1.0).otherwise(7.0)
    late = pl.when((pl.col("step") == 6) & (pl.col("episode") > 0)).then(None).otherwise(value)
    pl.read_parquet(path).with_columns(pta_c=late).write_parquet(path)
    found = time_series(Case(load_logs(folder), "graph", "greedy"), "pta_c")
    assert found.time.tolist() == pytest.approx([step / 12 for step in range(13)])
    assert (found.mean[0], found.half[0], found.n[0]) == pytest.approx((4.0, 1.96, 10))
    assert (found.mean[6], found.half[6], found.n[6]) == (1.0, 0.0, 1)
    axes = canvas(4.0, 3.0).subplots()
    found.draw(axes, policy_styles(["greedy"])["greedy"], "-", 0, 1)
    band = np.asarray(axes.collections[0].get_paths()[0].vertices)
    first = band[np.isclose(band[:, 0], 0.0), 1]
    assert (first.min(), first.max()) == pytest.approx((4 - 1.96, 4 + 1.96))
