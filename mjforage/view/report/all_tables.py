"""All tables of the report: those of its page, and those of the files beside it."""

from dataclasses import dataclass, fields

from mjforage.view.page import Table
from mjforage.view.report.clearing import clearing_table
from mjforage.view.report.hull_tables import hulls_table
from mjforage.view.report.policy_pairs import comparison_table
from mjforage.view.report.reality_gap import gap_table, ladder_table
from mjforage.view.report.run_logs import RunLogs
from mjforage.view.report.text_tables import full_table, headline_table, paper_tables

SERIES = 300  # worlds and policies of the headline table on the page


@dataclass(frozen=True)
class ReportTables:
    """Tables by what they tell; None or nothing where they have nothing to tell."""

    headline: Table
    clearing: Table | None
    gap: tuple[Table, ...]
    hulls: Table | None
    papers: tuple[Table, ...]
    full: Table
    paired: Table | None

    @property
    def all(self) -> list[Table]:
        """They in their order."""
        several = (getattr(self, one.name) for one in fields(self))
        groups = (one if isinstance(one, tuple) else (one,) for one in several)
        return [table for group in groups for table in group if table is not None]


def draw_tables(logs: RunLogs, shown: RunLogs) -> ReportTables:
    """Tables of the policies that are shown; the headline is of all, if the page has room."""
    many = len(logs.series) > SERIES
    gap = (ladder_table(shown), gap_table(shown))
    return ReportTables(
        headline_table(shown if many else logs),
        clearing_table(shown),
        tuple(table for table in gap if table is not None),
        hulls_table({"": shown}),
        tuple(paper_tables(shown)),
        full_table(shown),
        comparison_table(shown),
    )


def whole_tables(logs: RunLogs, tables: ReportTables) -> list[Table]:
    """Tables for files: what the summary tells is told of all policies there."""
    whole = (headline_table(logs), *paper_tables(logs), full_table(logs))
    of_all = {table.name: table for table in whole}
    return [of_all.get(table.name, table) for table in tables.all]
