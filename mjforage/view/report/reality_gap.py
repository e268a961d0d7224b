"""The reality gap: the same episodes in several worlds, paired, and what each piece of it costs."""

import itertools

from mjforage.core.mission_metrics import Description, describe
from mjforage.core.scenario_file import scenario_from_tree
from mjforage.physics.worlds import added
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
    """Every metric at graph level and in the last world, with the paired difference.

    None unless the run has the graph and another world.
    """
    worlds = logs.run.worlds
    if len(worlds) < 2 or worlds[0] != "graph":
        return None
    first, last = worlds[0], worlds[-1]
    metrics = logs.metrics.values()
    lines = [
        (policy, metric, _step(logs, (last, policy), (first, policy), metric))
        for policy in logs.policies
        for metric in metrics
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
        rows.append(Row(metric.label, cells, group=policy, best=best, values=values))
    notes = (
        "The same episodes in both worlds: equal items, drift and starts. Difference: "
        f"{last} minus {first}, mean over the episodes where both are defined, with the bootstrap "
        f"95 % interval of itself alone; {family_note(family)} (p).",
    )
    columns = (first, last, "difference", "95 % interval", "p", "n")
    return Table("gap", "The reality gap", columns, tuple(rows), notes)


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
    columns = tuple(metric.label for metric in metrics)
    return Table("ladder", "The gap ladder", columns, tuple(rows), notes)
