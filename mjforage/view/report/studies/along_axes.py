"""Tables of a study whose variants lie along axes."""

from collections.abc import Sequence

from mjforage.runs.studies.axes import OWN, Axis
from mjforage.runs.studies.variants import COMPLETE
from mjforage.view.page.table import Table
from mjforage.view.report.contrasts import Contrast, differences_table, means_table
from mjforage.view.report.run_logs import Case, policy_name
from mjforage.view.report.studies.study_logs import StudyLogs


def _groups(
    logs: StudyLogs, axes: Sequence[Axis], world: str, policy: str
) -> dict[str, dict[str, Case]]:
    """Heading -> cases of a policy along an axis; a variant of several axes once."""
    wanted = {axis.heading: [point.variant for point in axis.points] for axis in axes}
    wanted["As the scenario has it"] = [OWN]
    left = [name for name in logs.runs if logs.plays(policy, name)]
    found = {}
    for heading, names in wanted.items():
        here = [name for name in names if name in left]
        left = [name for name in left if name not in here]
        if here:
            found[heading] = {logs.title(n): logs.case(n, world, policy) for n in here}
    return found


def tables_along(
    logs: StudyLogs, axes: Sequence[Axis], compared: tuple[str, ...], shown: tuple[str, ...]
) -> list[Table]:
    """Differences to the scenario as it is, then means: a pair of tables per policy and world.

    `compared`, `shown`: keys of metrics; those that no variant was played with are left out.
    """
    tables, head = [], logs.title(COMPLETE)
    for policy in logs.policies:
        for world in logs.worlds:
            base, groups = logs.case(COMPLETE, world, policy), _groups(logs, axes, world, policy)
            contrasts = [
                Contrast(name, case, base, group)
                for group, cases in groups.items()
                for name, case in cases.items()
            ]
            title = policy_name(policy, logs.bounds) + logs.suffix(world)
            end, minus = f"{world}-{policy}", f"{title}: difference to {head}"
            groups = {"": {head: base}, **groups}
            tables += [
                differences_table(f"minus-{end}", minus, logs.measured(compared), contrasts),
                means_table(f"means-{end}", f"{title}: means", logs.measured(shown), groups),
            ]
    return tables


def reference_table(
    logs: StudyLogs, axis: Axis, name: str, title: str, keys: tuple[str, ...]
) -> Table:
    """Points of an axis minus the variant that it is compared with, policy by policy."""
    contrasts = [
        Contrast(
            logs.title(point.variant),
            logs.case(point.variant, world, policy),
            logs.case(axis.against, world, policy),
            policy_name(policy, logs.bounds) + logs.suffix(world),
        )
        for policy in logs.policies
        for world in logs.worlds
        for point in axis.points
        if point.variant != axis.against
        and logs.plays(policy, point.variant)
        and logs.plays(policy, axis.against)
    ]
    return differences_table(name, title, logs.measured(keys), contrasts)
