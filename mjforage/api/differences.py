"""Paired differences between policies, or worlds, of a run."""

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from mjforage.api import checks
from mjforage.base.errors import UserError
from mjforage.metrics import count, episodes_needed, sem

if TYPE_CHECKING:
    from mjforage.view.report.contrasts import Contrast
    from mjforage.view.report.run_logs import RunLogs

COLUMNS = ("world", "policy", "metric", "difference", "low", "high", "p", "n")
NEEDED = ("world", "policy", "metric", "sd", "episodes")


def differences_of(
    logs: "RunLogs",
    policy: str | None,
    against: str | None,
    world: str | tuple[str, str] | None,
    metrics: str | Sequence[str],
) -> pl.DataFrame:
    """The table of `Run.differences`."""
    from mjforage.view.report.differences import estimates

    keys = [checks.one_of("metric", key, logs.metrics) for key in checks.texts("metrics", metrics)]
    found = [
        (where, who, logs.metrics[key], contrast)
        for where, who, contrast in _contrasts(_pairs(logs, policy, against, world), logs)
        for key in keys or logs.metrics
        if np.isfinite(contrast.gaps(logs.metrics[key])).any()
    ]
    family = estimates([(contrast.gaps(metric), metric.digits) for *_, metric, contrast in found])
    rows = [
        (where, who, metric.key, gap.value, *map(_known, (gap.low, gap.high, gap.p)), gap.n)
        for (where, who, metric, _), gap in zip(found, family, strict=True)
    ]
    return pl.DataFrame(rows, schema=COLUMNS, orient="row")


def needed_of(logs: "RunLogs", difference: float, metric: str) -> pl.DataFrame:
    """The table of `Run.episodes_needed`."""
    one = logs.metrics[checks.one_of("metric", metric, logs.metrics)]
    size = checks.real("difference", difference, above=0.0)
    worlds, policies = logs.run.worlds, logs.run.policies
    pairs = [(a, here, b, here) for here in worlds for a, b in combinations(policies, 2)]
    pairs += [(who, b, who, a) for a, b in combinations(worlds, 2) for who in policies]
    if not pairs:
        raise UserError(
            f"difference {size:g}: one policy in one world has none; name two policies, or compare"
        )
    rows = []
    for where, who, contrast in _contrasts(pairs, logs):
        gaps = contrast.gaps(one)
        sd = float(sem(gaps) * np.sqrt(count(gaps)))
        rows.append((where, who, one.key, _known(sd), episodes_needed(gaps, size)))
    return pl.DataFrame(rows, schema=NEEDED, orient="row")


def _known(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _contrasts(
    pairs: Sequence[tuple[str, str, str, str]], logs: "RunLogs"
) -> list[tuple[str, str, "Contrast"]]:
    """World and policy in words, and what is compared."""
    from mjforage.view.report.contrasts import Contrast
    from mjforage.view.report.run_logs import Case

    return [
        (
            here if here == there else f"{here} - {there}",
            one if one == other else f"{one} - {other}",
            Contrast("", Case(logs, here, one), Case(logs, there, other)),
        )
        for one, here, other, there in pairs
    ]


def _pairs(
    logs: "RunLogs", policy: str | None, against: str | None, world: object
) -> list[tuple[str, str, str, str]]:
    """Policy and world, and those that are subtracted."""
    for name in (policy, against):
        if name is not None:
            checks.one_of("policy", name, logs.run.policies)
    worlds = checks.texts("world", () if world is None else world)
    for name in worlds:
        checks.one_of("world", name, logs.run.worlds)
    if len(worlds) > 2:
        raise UserError(f"world {worlds}: give one, or two as (first, second)")
    if len(worlds) == 2:
        chosen = [policy] if policy else list(logs.run.policies)
        return [(one, worlds[1], against or one, worlds[0]) for one in chosen]
    if policy is None or against is None:
        raise UserError(
            'differences: give two policies, or two worlds as in world=("graph", "physics")'
        )
    return [(policy, one, against, one) for one in worlds or logs.run.worlds]
