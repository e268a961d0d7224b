"""Tables of players beside one another: their means, and differences on the same episodes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mjforage.core.mission_metrics import describe
from mjforage.view.page import style
from mjforage.view.page.table import Row, Table
from mjforage.view.report.differences import Difference, family_note, set_apart
from mjforage.view.report.studies.study_logs import Player, StudyLogs
from mjforage.view.report.text_tables import in_full, plus_minus


@dataclass(frozen=True)
class Line:
    """A player under its name in these tables."""

    head: str
    player: Player

    @property
    def colour(self) -> str:
        """Colour of its policy."""
        return style.policy_colour(self.player.policy)


def means_table(
    logs: StudyLogs, name: str, title: str, keys: Sequence[str], groups: Mapping[str, list[Line]]
) -> Table:
    """Mean of each metric, group by group of lines."""
    metrics = [describe(key) for key in keys]
    rows = [
        Row(
            line.head,
            tuple(plus_minus(logs.entry(line.player, m.key), m.digits) for m in metrics),
            line.colour,
            group=group,
            values=tuple(in_full(logs.entry(line.player, m.key)) for m in metrics),
        )
        for group, lines in groups.items()
        for line in lines
    ]
    labels, units = tuple(m.label for m in metrics), tuple(m.unit for m in metrics)
    better = tuple(m.better for m in metrics)
    notes = ("Mean ± 1.96 SEM.",)
    return Table(name, title, labels, tuple(rows), notes, units, head="variant", better=better)


def difference(logs: StudyLogs, line: Line, against: Line, key: str) -> Difference:
    """A metric of one line minus that of another, over the same episodes."""
    x, y = (logs.values(one.player, key) for one in (line, against))
    return Difference(x, y, describe(key))


def differences_table(
    logs: StudyLogs,
    name: str,
    title: str,
    keys: Sequence[str],
    groups: Mapping[str, tuple[Line, list[Line]]],
) -> Table:
    """Each group of lines against its own reference."""
    compared = [
        (group, line, [difference(logs, line, against, key) for key in keys])
        for group, (against, lines) in groups.items()
        for line in lines
    ]
    family = [step for _, _, steps in compared for step in steps]
    apart = iter(set_apart(family))
    rows = [
        Row(
            line.head,
            tuple(step.cell for step in steps),
            line.colour,
            best=frozenset(place for place in range(len(steps)) if next(apart)),
            group=group,
            values=tuple(step.full for step in steps),
        )
        for group, line, steps in compared
    ]
    note = (
        "Mean difference over the same episodes, with its bootstrap 95 % interval of itself alone; "
        f"{family_note(family)}."
    )
    metrics = [describe(key) for key in keys]
    labels, units = tuple(m.label for m in metrics), tuple(m.unit for m in metrics)
    table = Table(name, title, labels, tuple(rows), (note,), units, stacked=True, head="variant")
    return replace(table, better=tuple(m.better for m in metrics))
