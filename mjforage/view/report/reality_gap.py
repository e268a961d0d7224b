"""The reality gap: the same episodes in several worlds, paired, and what each piece of it costs."""

import itertools

from mjforage.core.scenario_file import scenario_from_tree
from mjforage.core.vocabulary import HEADLINE, METRICS, Metric, describe
from mjforage.physics.worlds import added
from mjforage.view.report.differences import Difference
from mjforage.view.report.run_logs import RunLogs, Series
from mjforage.view.report.text_tables import Row, Table, entry_of, plus_minus


def _step(logs: RunLogs, here: Series, there: Series, metric: Metric) -> Difference:
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
    rows = []
    for policy in logs.policies:
        for metric in METRICS.values():
            pair = (last, policy), (first, policy)
            means = (
                plus_minus(entry_of(logs.summary, series, metric.key), metric.digits)
                for series in reversed(pair)
            )
            step = _step(logs, *pair, metric)
            best = frozenset({2}) if step.apart else frozenset()
            cells = (*means, step.text, step.interval, str(step.n))
            rows.append(Row(metric.label, cells, group=policy, best=best))
    notes = (
        "The same episodes in both worlds: equal items, drift and starts. Difference: "
        f"{last} minus {first}, mean over the episodes where both are defined, with the bootstrap "
        "95 % interval; bold where it leaves out zero.",
    )
    columns = (first, last, "difference", "95 % interval", "n")
    return Table("gap", "The reality gap", columns, tuple(rows), notes)


def ladder_table(logs: RunLogs) -> Table | None:
    """What each world adds to the one before it, in the headline metrics.

    None with fewer than three worlds.
    """
    worlds = logs.run.worlds
    if len(worlds) < 3:
        return None
    metrics = [describe(key) for key in HEADLINE]
    rows = []
    for policy in logs.policies:
        for before, world in itertools.pairwise(worlds):
            pair = (world, policy), (before, policy)
            steps = [_step(logs, *pair, metric) for metric in metrics]
            cells = tuple(step.cell for step in steps)
            best = frozenset(place for place, step in enumerate(steps) if step.apart)
            rows.append(Row(f"+ {world}", cells, group=policy, best=best))
    scenario = scenario_from_tree(dict(logs.run.scenario), str(logs.folder / "run.json"))
    words = "; ".join(
        f"+ {world}: {', '.join(added(scenario, before, world)) or 'nothing'}"
        for before, world in itertools.pairwise(worlds)
    )
    notes = (
        "Each row adds a piece of reality to the row above, on the same episodes: paired mean "
        f"difference and bootstrap 95 % interval; bold where it leaves out zero. {words}.",
    )
    columns = tuple(metric.label for metric in metrics)
    return Table("ladder", "The gap ladder", columns, tuple(rows), notes)
