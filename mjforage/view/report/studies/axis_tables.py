"""Tables of a study along axes: what every variant differs from its reference, and means."""

from collections.abc import Sequence

from mjforage.runs.axes import OWN, Axis
from mjforage.runs.variants import COMPLETE
from mjforage.view.page import style
from mjforage.view.page.table import Table
from mjforage.view.report.studies.compared_players import Line, differences_table, means_table
from mjforage.view.report.studies.study_logs import Player, StudyLogs
from mjforage.view.report.text_tables import policy_name


def measured(logs: StudyLogs, keys: Sequence[str]) -> tuple[str, ...]:
    """Those metrics that are defined in any episode of any variant."""
    tables = logs.episodes.values()
    return tuple(
        key for key in keys if any(key in table.columns and table[key].count() for table in tables)
    )


def _lines(logs: StudyLogs, axes: Sequence[Axis], world: str, policy: str) -> dict[str, list[Line]]:
    """Heading -> what a policy has played of an axis; a variant of several axes once."""
    wanted = {axis.heading: [point.variant for point in axis.points] for axis in axes}
    wanted["As the scenario has it"] = [OWN]
    left = [name for name, run in logs.runs.items() if policy in run.policies]
    found = {}
    for heading, names in wanted.items():
        here = [name for name in names if name in left]
        left = [name for name in left if name not in here]
        if here:
            lines = [Line(logs.title(name), Player(name, world, policy)) for name in here]
            found[heading] = lines
    return found


def tables_along(
    logs: StudyLogs, axes: Sequence[Axis], compared: Sequence[str], shown: Sequence[str]
) -> list[Table]:
    """Differences to the scenario as it is, then means: a pair of tables per policy and world.

    Parameters
    ----------
    compared, shown : keys of metrics; those that no variant was played with are left out
    """
    tables = []
    for policy in style.ordered(logs.base.policies):
        for world in logs.worlds:
            base = Line(logs.title(COMPLETE), Player(COMPLETE, world, policy))
            groups = _lines(logs, axes, world, policy)
            end = f"{policy_name(policy, logs.bounds)}{logs.suffix(world)}"
            name = f"{world}-{policy}"
            tables += [
                differences_table(
                    logs,
                    f"minus-{name}",
                    f"{end}: difference to {base.head}",
                    measured(logs, compared),
                    {heading: (base, lines) for heading, lines in groups.items()},
                ),
                means_table(
                    logs,
                    f"means-{name}",
                    f"{end}: means",
                    measured(logs, shown),
                    {"": [base], **groups},
                ),
            ]
    return tables


def reference_table(
    logs: StudyLogs, axis: Axis, name: str, title: str, keys: Sequence[str]
) -> Table:
    """Points of an axis minus the variant that it is compared with, policy by policy."""
    groups = {}
    for policy in style.ordered(logs.base.policies):
        for world in logs.worlds:
            names = [one.variant for one in axis.points if one.variant in logs.runs]
            names = [one for one in names if policy in logs.runs[one].policies]
            lines = [Line(logs.title(one), Player(one, world, policy)) for one in names]
            if axis.against in names:
                place = names.index(axis.against)
                rest = [*lines[:place], *lines[place + 1 :]]
                groups[policy_name(policy, logs.bounds) + logs.suffix(world)] = (lines[place], rest)
    return differences_table(logs, name, title, measured(logs, keys), groups)
