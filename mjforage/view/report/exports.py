"""Tables and figures of a report as files for a paper, in the formats wanted."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from mjforage.base.atomic_files import write_bytes
from mjforage.base.errors import UserError
from mjforage.view.page.figure import house_style, pdf_bytes, png_bytes, svg_bytes
from mjforage.view.page.table import Table
from mjforage.view.page.table_files import FORMATS, write_table
from mjforage.view.report.run_logs import RunLogs
from mjforage.view.report.sections import Page

FIGURES: dict[str, Callable[[Figure], bytes]] = {
    "pdf": pdf_bytes,
    "png": png_bytes,
    "svg": partial(svg_bytes, as_text=True),
}
"""Format and ending of a figure's file -> what draws it; letters are text where they can be."""


@dataclass(frozen=True)
class Exports:
    """Formats that are wanted besides those of every report.

    Attributes
    ----------
    tables : of `table_files.FORMATS`
    figures : of `FIGURES`
    """

    tables: tuple[str, ...] = ()
    figures: tuple[str, ...] = ()

    @classmethod
    def of(cls, tables: Sequence[str], figures: Sequence[str]) -> "Exports":
        """Formats that a user names, of tables and of figures.

        Raises `UserError` if a format is not one of ours.
        """
        return cls(_chosen("tables", tables, FORMATS), _chosen("figures", figures, FIGURES))


NOTHING_ELSE = Exports()


def _chosen(what: str, names: Sequence[str], known: Collection[str]) -> tuple[str, ...]:
    for name in names:
        if name not in known:
            raise UserError(f"{what}: no format {name!r}; choose from {', '.join(known)}")
    return tuple(dict.fromkeys(names))


def write_page(
    folder: Path,
    page: Page,
    logs: RunLogs,
    wanted: Exports = NOTHING_ELSE,
    more: Sequence[Table] = (),
) -> Path:
    """Write ``report.html``, tables into ``tables``, always as CSV, and figures into ``figures``.

    Raises `UserError` if a file cannot be written.

    Parameters
    ----------
    logs : run whose recorded episodes the page plays
    more : tables that are written as files only, instead of the page's of the same names
    """
    text = page.text(folder, logs)
    for table in (*page.tables, *more):
        write_table(table, folder / "tables", ("csv", *wanted.tables))
    for picture in page.pictures:
        for kind in wanted.figures:
            with house_style():
                content = FIGURES[kind](picture.figure)
            write_bytes(folder / "figures" / f"{picture.file}.{kind}", content)
    write_bytes(folder / "report.html", text.encode("utf-8"))
    return folder / "report.html"
