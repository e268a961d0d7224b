"""A page of sections: the same for reports of runs and of studies."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from typing import Any

from mjforage.view.page import EmbeddedFigure, Table, embedded_within, render_page
from mjforage.view.page.figure import ReportFigure
from mjforage.view.report.run_logs import RunLogs
from mjforage.view.report.web_replay import BUDGET, WebReplay, web_replay

LARGEST = 4_800_000  # characters of a page, but for the captions and the player's script
FIGURES = 2_800_000  # characters of all its figures
ROWS, FEWEST_ROWS = 3000, 20  # of a table: at most, and at least where several need room


@dataclass(frozen=True)
class Section:
    """A part of a page. Words may carry subscripts and code as tables do."""

    name: str  # anchor
    title: str
    words: str = ""
    tables: Sequence[Table] = ()
    pictures: Sequence[ReportFigure] = ()
    folded: Sequence[Table] = ()  # after the pictures, closed where they are long
    facts: Sequence[tuple[str, str]] = ()  # terms and their values
    texts: Mapping[str, str] = field(default_factory=dict)  # heading -> text, such as a command
    items: Sequence[str] = ()  # of a list
    details: Mapping[str, str] = field(default_factory=dict)  # heading -> text, closed

    @property
    def numbers(self) -> list[Table]:
        """All tables that have rows; others are on no page."""
        return [table for table in (*self.tables, *self.folded) if table.rows]

    @property
    def empty(self) -> bool:
        """True if nothing is in it."""
        parts = (self.words, self.numbers, self.pictures, self.facts, self.items, self.details)
        return not any(parts)


@dataclass(frozen=True)
class Page:
    """A page as the template sets it, without its figures and its replay."""

    heading: str
    lead: str
    sections: Sequence[Section]
    version: str  # of the mjforage that made the numbers
    kind: str = "report"
    chips: Mapping[str, str] = field(default_factory=dict)  # policy -> colour, below the lead

    @property
    def tables(self) -> list[Table]:
        """All tables."""
        return [table for section in self.sections for table in section.numbers]

    @property
    def pictures(self) -> list[ReportFigure]:
        """All figures."""
        return [picture for section in self.sections for picture in section.pictures]

    def text(self, folder: Path, logs: RunLogs) -> str:
        """The page as HTML below 5 MB; its figures are saved in a folder.

        Tables have fewer rows where they leave no room for figures, and say so.

        `logs`: run whose recorded episodes the page plays.
        """
        rows = ROWS
        while (room := LARGEST - len(self._set(rows))) < FIGURES and rows > FEWEST_ROWS:
            rows //= 2
        figures = embedded_within(min(FIGURES, room), self.pictures, folder)
        room -= sum(len(figure.source) for figure in figures)
        return self._set(rows, figures, web_replay(logs, min(BUDGET, room)))

    def _set(
        self, rows: int, figures: Sequence[EmbeddedFigure] = (), replay: WebReplay | None = None
    ) -> str:
        drawn, parts = iter(figures), []
        for section in self.sections:
            if section.empty:
                continue
            shown = list(islice(drawn, len(section.pictures)))
            tables, folded = (
                [cut(one, rows) for one in several if one.rows]
                for several in (section.tables, section.folded)
            )
            wide, narrow = ([one for one in shown if one.wide is w] for w in (True, False))
            own = {"tables": tables, "folded": folded, "wide": wide, "narrow": narrow}
            parts.append(vars(section) | own)
        content: dict[str, Any] = vars(self) | {"sections": parts, "replay": replay}
        return render_page("sections.html.j2", content.pop("version"), content)


def cut(table: Table, rows: int = ROWS) -> Table:
    """A table with no more rows than a page has room for, and a note on the others."""
    if len(table.rows) <= rows:
        return table
    note = f"The first {rows} of {len(table.rows)} rows; the files in `tables/` have all."
    return replace(table, rows=table.rows[:rows], notes=(*table.notes, note))
