"""Numbers of tables: their origins in the results of commands."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from mjforage.mission.scoring import describe
from mjforage.runs.parquet import read_parquet
from mjforage.view.report.differences import estimates
from mjforage.view.report.studies import ablation, corruption
from tests.evidence import returns, trained, tutorials
from tests.evidence.cells import average, beside, defined, gap, interval, mean
from tests.evidence.piece import Cell, Piece, Row, Spec
from tests.evidence.playing import Runs
from tests.mjforage.bench import hulls_in_turn

GRAPH = "graph"


def values(spec: Spec, runs: Runs) -> NDArray[Any]:
    """A metric of a policy, in the first world of a run if none is named: (episode,)."""
    if "variant" in spec:
        case = runs.study.case(spec["variant"], spec.get("world", GRAPH), spec["policy"])
        return case.values(spec["key"])
    return runs[spec["run"]].values(spec["policy"], spec["key"], spec.get("world"))


def horizon(spec: Spec, runs: Runs) -> int:
    """Steps of the missions of a number."""
    info = runs.study.base if "variant" in spec else runs[spec["run"]].info
    return info.horizon


def mean_of(spec: Spec, runs: Runs) -> Cell:
    """Mean of a metric of a policy, with its interval."""
    return mean(values(spec, runs), describe(spec["key"]), horizon(spec, runs))


def entry(spec: Spec, runs: Runs) -> Cell:
    """Mean of a variant of a study, with its interval."""
    case = runs.study.case(spec["variant"], GRAPH, spec["policy"])
    found = case.summary(spec["key"])
    return defined(mean=found.mean, low=found.low, high=found.high)


def contribution(spec: Spec, runs: Runs) -> Cell:
    """Marginal contribution of one of a team."""
    about = spec["team"], GRAPH, spec["policy"], spec["key"]
    (found,) = estimates([ablation.contribution(runs.study, *about)])
    return defined(mean=found.value, low=found.low, high=found.high)


def slope(spec: Spec, runs: Runs) -> Cell:
    """Slope of a metric over the corruption of a team."""
    fit = corruption.Fits(runs.study).of(spec["team"], GRAPH, spec["policy"], spec["key"])
    assert fit is not None
    low, high = fit.intervals.slope
    return defined(mean=fit.line.slope, low=low, high=high)


def break_point(spec: Spec, runs: Runs) -> Cell:
    """Corruption of a team where the slope of a metric changes."""
    fit = corruption.Fits(runs.study).of(spec["team"], GRAPH, spec["policy"], spec["key"])
    assert fit is not None
    low, high = fit.intervals.break_point
    return defined(mean=fit.bent.break_point, low=low, high=high)


def impact(spec: Spec, runs: Runs) -> Cell:
    """Fastest approach to a touch of a quay or hull [m/s]."""
    keys = ("world", "policy", "episode", "impact_mps")
    file = runs[spec["run"]].folder / "agents.parquet"
    wanted = (pl.col("world") == spec["world"]) & (pl.col("policy") == spec["policy"])
    rows = read_parquet(file, keys, wanted)
    return defined(mean=rows["impact_mps"].max())  # type: ignore[arg-type]


OF_TWO: dict[str, Callable[[NDArray[Any], NDArray[Any]], Cell]] = {
    "gap": gap,
    "beside": beside,
    "interval": interval,
}
OTHERS: dict[str, Callable[[Spec, Runs], Cell]] = {
    "mean": mean_of,
    **{each.__name__: each for each in (entry, contribution, slope, break_point, impact)},
}


def number(spec: Spec, runs: Runs) -> Cell:
    """A number of a table."""
    way = spec["way"]
    if way == "average":
        return average(values(spec, runs))
    if way in OF_TWO:
        return OF_TWO[way](values(spec, runs), values({**spec, **spec["minus"]}, runs))
    return OTHERS[way](spec, runs)


def validation(runs: Runs) -> Iterator[list[Cell]]:
    """Of each check the measure that is nearest to its limit."""
    for number, name, what, value, *rest in runs.figures:
        yield [number, f"`{name}`", what, {"mean": value}, *rest]


def listed(runs: Runs) -> Iterator[list[Cell]]:
    """Rows of words and then numbers."""
    for what, *values in runs.figures:
        yield [what, *({"mean": value} for value in values)]


def speeds(runs: Runs) -> Iterator[list[Cell]]:
    """Each figure of `mjforage bench`."""
    for key, figure in runs.figures.items():
        value, quickest = ({"mean": figure[name]} for name in ("value", "quickest"))
        yield [f"`{key}`", value, quickest, figure["unit"]]


def speeds_of_hulls(runs: Runs) -> Iterator[list[Cell]]:
    """Batches of hulls by their size: rates, and ratios of slices that followed each other."""
    for size in hulls_in_turn.SIZES:
        keys = (key.format(size) for key in hulls_in_turn.COLUMNS)
        alone, one, two = (np.array(runs.figures.get(key, np.nan)) for key in keys)
        yield [f"{size}", *map(spread, (alone, one, one / alone, two, two / one))]


def spread(values: NDArray[Any]) -> Cell:
    """Median and range of values, NaN left out."""
    known = values[~np.isnan(values)]
    if not known.size:
        return {}
    return defined(mean=np.median(known), low=known.min(), high=known.max())


def decision_times(runs: Runs) -> Iterator[list[Cell]]:
    """Times of each policy by the size of the fleet, those that plan first."""
    found: dict[str, list[Cell]] = {}
    for one in runs.figures:
        number = {"mean": one["ms"], "low": one["low"], "high": one["high"]}
        found.setdefault(one["policy"], []).append(one["reason"] or number)
    order = (
        *("belief", "dec-mcts", "auction", "ddqn", "ddqn-reward"),
        *("ddqn-link", "mappo", "greedy", "lawnmower", "levy", "wanderer", "pso", "random"),
    )
    for policy in (*order, *sorted(set(found) - set(order))):
        yield [f"`{policy}`", *found[policy]]


def picking(runs: Runs) -> Iterator[list[Cell]]:
    """Shares taken within each decision, for each way of seeing the item, place by place."""
    words = {
        "open_water": "the next node, open water",
        "straight_quay": "straight quay, from the node or one beside it",
        "corner_from_within": "corner, from the node",
        "corner_from_beside": "corner, from a node beside it",
    }
    for place, head in words.items():
        shares = [share for one in runs.figures if one["place"] == place for share in one["shares"]]
        yield [head, *({"mean": share} for share in shares)]


def coverage_rows(runs: Runs) -> Iterator[list[Cell]]:
    """Metric by metric the share of samples whose interval holds the mean."""
    for name, *shares in runs.figures:
        yield [name, *("" if share is None else {"mean": share} for share in shares)]


WHOLE: dict[str, Callable[[Runs], Iterator[list[Cell]]]] = {
    "validation": validation,
    "contacts": listed,
    "random-minutes": listed,
    "speeds": speeds,
    "speeds-hulls": speeds_of_hulls,
    "decision-times": decision_times,
    "picking": picking,
    "coverage": coverage_rows,
    "equals": listed,
    "family-seeds": trained.seeds,
    "family-elsewhere": trained.elsewhere,
    "tuned-in-physics": trained.tuned,
    "rewards": returns.rewards,
    "rewards-learnt": returns.learnt,
    "rewards-learnt-on-hulls": returns.learnt_on_hulls,
    "scores": tutorials.scores,
}
"""Tables that are no numbers of runs and studies."""


def made_row(piece: Piece, row: Row, runs: Runs) -> Row:
    """A row whose numbers are made from runs."""
    cells = [
        number(piece.spec(column, row), runs) if isinstance(cell, dict) else cell
        for cell, column in zip(row.cells, piece.columns, strict=True)
    ]
    return Row(cells, row.of)


def made_rows(piece: Piece, runs: Runs) -> list[Row]:
    """All rows of a piece, from the results of its commands."""
    if piece.name in WHOLE:
        return [Row(cells) for cells in WHOLE[piece.name](runs)]
    return [made_row(piece, row, runs) for row in piece.rows]
