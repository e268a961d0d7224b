"""The reality gap: the same episodes in several worlds, paired, and what each piece of it costs."""

import itertools
from dataclasses import replace

from mjforage.mission.mission_metrics import Description, describe
from mjforage.physics.worlds import added
from mjforage.scenario.scenario_file import scenario_from_tree
from mjforage.view.page.table import Number, Row, Table
from mjforage.view.report.differences import (
    Difference,
    corrected,
    family_note,
    p_text,
    set_apart,
)
from mjforage.view.report.run_logs import RunLogs, Series
from mjforage.view.report.text_tables import HEADLINE, entry_of, in_full, plus_minus


def _step(logs: RunLogs, here: Series, there: Series, metric: Description) -> Difference:
    """One world minus another in one metric, over the same episodes of a policy."""
    return Difference(logs.scalar(here, metric.key), logs.scalar(there, metric.key), metric)


def gap_table(logs: RunLogs) -> Table | None:
    """Every metric in the first and the last world, with the paired difference.

    None with one world. Metrics that no episode of a policy defines are left out, and named if none
    of any does.
    """
    worlds = logs.run.worlds
    if len(worlds) < 2:
        return None
    first, last = worlds[0], worlds[-1]
    metrics = [one for one in logs.metrics.values() if logs.defined(one.key)]
    nowhere = [one.label for one in logs.metrics.values() if not logs.defined(one.key)]
    lines = [
        (policy, metric, _step(logs, (last, policy), (first, policy), metric))
        for policy in logs.policies
        for metric in metrics
        if any(entry_of(logs.summary, (world, policy), metric.key).n for world in (first, last))
    ]
    family = [step for _, _, step in lines]
    rows = []
    for (policy, metric, step), p, apart in zip(
        lines, corrected(family), set_apart(family), strict=True
    ):
        ends = [entry_of(logs.summary, (world, policy), metric.key) for world in (first, last)]
        means = (plus_minus(entry, metric.digits) for entry in ends)
        cells = (*means, step.text, step.interval, p_text(p), str(step.n))
        best = frozenset({2} if apart else ())
        values = (*map(in_full, ends), *step.split, Number(p), Number(step.n))
        row = Row(metric.head, cells, group=policy, best=best, values=values)
        rows.append(replace(row, better=metric.better))
    notes = (
        "The same episodes in both worlds: equal items, drift and starts. Difference: "
        f"{last} minus {first}, mean over the episodes where both are defined, with the bootstrap "
        f"95 % interval of itself alone; {family_note(family)} (p).",
        *([f"Undefined in every episode: {', '.join(nowhere)}."] if nowhere else []),
    )
    columns = (first, last, "difference", "95 % interval", "p", "n")
    title = f"Every metric, {last} minus {first}"
    return Table("gap", title, columns, tuple(rows), notes, head="metric")


def ladder_table(logs: RunLogs) -> Table | None:
    """What each world adds to the one before it, in the headline metrics.

    None with fewer than three worlds.
    """
    worlds = logs.run.worlds
    if len(worlds) < 3:
        return None
    metrics = [describe(key) for key in HEADLINE]
    lines = [
        (policy, world, [_step(logs, (world, policy), (before, policy), one) for one in metrics])
        for policy in logs.policies
        for before, world in itertools.pairwise(worlds)
    ]
    family = [step for _, _, steps in lines for step in steps]
    apart = iter(set_apart(family))
    rows = [
        Row(
            f"+ {world}",
            tuple(step.cell for step in steps),
            group=policy,
            best=frozenset(place for place in range(len(steps)) if next(apart)),
            values=tuple(step.full for step in steps),
        )
        for policy, world, steps in lines
    ]
    scenario = scenario_from_tree(dict(logs.run.scenario), str(logs.folder / "run.json"))
    words = "; ".join(
        f"+ {world}: {', '.join(added(scenario, before, world)) or 'nothing'}"
        for before, world in itertools.pairwise(worlds)
    )
    notes = (
        "Each row adds a piece of reality to the row above, on the same episodes: paired mean "
        f"difference and bootstrap 95 % interval of itself alone; {family_note(family)}. {words}.",
    )
    labels, units = tuple(one.label for one in metrics), tuple(one.unit for one in metrics)
    table = Table("ladder", "The gap ladder", labels, tuple(rows), notes, units, head="world")
    return replace(table, better=tuple(one.better for one in metrics))
