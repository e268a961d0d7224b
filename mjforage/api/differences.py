"""Paired differences between policies, or worlds, of a run."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import polars as pl

from mjforage.api import checks
from mjforage.base.errors import UserError

if TYPE_CHECKING:
    from mjforage.view.report.contrasts import Contrast
    from mjforage.view.report.run_logs import RunLogs

COLUMNS = ("world", "policy", "metric", "difference", "low", "high", "p", "p_holm", "n")


def differences_of(
    logs: "RunLogs",
    policy: str | None,
    against: str | None,
    world: str | tuple[str, str] | None,
    metrics: str | Sequence[str],
) -> pl.DataFrame:
    """The table of `Run.differences`."""
    from mjforage.view.report.differences import corrected

    keys = [checks.one_of("metric", key, logs.metrics) for key in checks.texts("metrics", metrics)]
    found = [
        (where, who, key, gap)
        for where, who, contrast in _contrasts(logs, policy, against, world)
        for key in keys or logs.metrics
        if (gap := contrast.gap(logs.metrics[key])).n
    ]
    p_holm = corrected([gap for *_, gap in found])
    rows = [
        (where, who, key, gap.value, gap.low, gap.high, gap.p, p, gap.n)
        for (where, who, key, gap), p in zip(found, p_holm, strict=True)
    ]
    return pl.DataFrame(rows, schema=COLUMNS, orient="row")


def _contrasts(
    logs: "RunLogs", policy: str | None, against: str | None, world: object
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
        for one, here, other, there in _pairs(logs, policy, against, world)
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
