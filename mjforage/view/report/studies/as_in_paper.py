"""References to the paper: its figures by number, and marks on policies that were taught."""

from collections.abc import Sequence
from dataclasses import replace

from mjforage.view.page.figure import ReportFigure
from mjforage.view.page.table import Table
from mjforage.view.report.published import NUMBERS, TAUGHT
from mjforage.view.report.sections import Section

MARK = "taught by the planner"
NOTE = (
    "Policies marked as taught by the planner were trained on demonstrations of `belief`. The "
    "paper's network (DRL) learnt from reward alone, and stands beside its like, `ddqn-reward`."
)


def referred(sections: Sequence[Section]) -> list[Section]:
    """The sections with the paper's numbers in titles of figures, and marks on taught policies."""
    return [
        replace(
            section,
            tables=[_marked(table) for table in section.tables],
            pictures=[_numbered(picture) for picture in section.pictures],
        )
        for section in sections
    ]


def _numbered(picture: ReportFigure) -> ReportFigure:
    number = NUMBERS.get(picture.name)
    return replace(picture, title=f"{picture.title} (paper's {number})") if number else picture


def _marked(table: Table) -> Table:
    rows = (replace(row, head=_name(row.head), group=_name(row.group)) for row in table.rows)
    return replace(table, rows=tuple(rows))


def _name(words: str) -> str:
    """A policy, alone or before its world, with the mark where it was taught."""
    policy, dot, rest = words.partition(" · ")
    return f"{policy} ({MARK}){dot}{rest}" if policy in TAUGHT else words
