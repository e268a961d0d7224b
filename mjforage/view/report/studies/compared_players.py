"""Tables of players beside one another: their means, and differences on the same episodes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mjforage.mission.mission_metrics import describe
from mjforage.view.page import style
from mjforage.view.page.table import Row, Table
from mjforage.view.report.differences import Difference, family_note, set_apart
from mjforage.view.report.studies.study_logs import Player, StudyLogs
from mjforage.view.report.text_tables import in_full, in_minutes, plus_minus


@dataclass(frozen=True)
class Line:
    """A player under its name in these tables."""

    head: str
    player: Player

    @property
    def look(self) -> style.PolicyStyle:
        """Colour and marker of its policy."""
        return style.policy_styles((self.player.policy,))[self.player.policy]

    @property
    def colour(self) -> str:
        """Colour of its policy."""
        return self.look.colour


def means_table(
    logs: StudyLogs, name: str, title: str, keys: Sequence[str], groups: Mapping[str, list[Line]]
) -> Table:
    """Mean of each metric, group by group of lines."""
    metrics = [describe(key) for key in keys]
    rows = []
    for group, lines in groups.items():
        for line in lines:
            entries = [logs.entry(line.player, m.key) for m in metrics]
            pairs = list(zip(entries, metrics, strict=True))
            cells = tuple(plus_minus(entry, m.digits) for entry, m in pairs)
            also = tuple(in_minutes(logs.runs[line.player.variant], m, one) for one, m in pairs)
            values = tuple(map(in_full, entries))
            rows.append(Row(line.head, cells, line.colour, group=group, values=values, also=also))
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
    """Each group of lines against its own reference; metrics without any difference left out."""
    compared = [
        (group, line, {key: difference(logs, line, against, key) for key in keys})
        for group, (against, lines) in groups.items()
        for line in lines
    ]
    keys = _told(keys, [found for _, _, found in compared])
    rows_of = [(group, line, [found[key] for key in keys]) for group, line, found in compared]
    family = [step for _, _, steps in rows_of for step in steps]
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
        for group, line, steps in rows_of
    ]
    note = (
        "Mean difference over the same episodes, with its bootstrap 95 % interval of itself alone; "
        f"{family_note(family)}."
    )
    metrics = [describe(key) for key in keys]
    labels, units = tuple(m.label for m in metrics), tuple(m.unit for m in metrics)
    table = Table(name, title, labels, tuple(rows), (note,), units, stacked=True, head="variant")
    return replace(table, better=tuple(m.better for m in metrics))


def _told(keys: Sequence[str], found: Sequence[Mapping[str, Difference]]) -> Sequence[str]:
    """Metrics of which some difference is defined; all of them where none is."""
    return [key for key in keys if any(one[key].n for one in found)] or keys
