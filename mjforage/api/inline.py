"""Parts of a run that a notebook shows: its table, and the web player of an episode."""

from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mjforage.view.page import Table


def table_html(table: "Table") -> str:
    """A table as HTML, the best of each column in bold."""
    heads = "".join(f"<th>{escape(one)}</th>" for one in (table.head, *table.columns))
    rows = [
        f"<th>{escape(row.head)}</th>"
        + "".join(
            f"<td><b>{escape(cell)}</b></td>" if place in row.best else f"<td>{escape(cell)}</td>"
            for place, cell in enumerate(row.cells)
        )
        for row in table.rows
    ]
    notes = "".join(f"<p><small>{escape(one)}</small></p>" for one in table.notes)
    body = "".join(f"<tr>{row}</tr>" for row in rows)
    return f'<table style="white-space: nowrap"><tr>{heads}</tr>{body}</table>{notes}'


class Player:
    """The web player of one episode: shown inline by a notebook; `str` gives the page."""

    def __init__(self, page: str, words: str) -> None:
        self._page, self._words = page, words

    def __str__(self) -> str:
        return self._page

    def __repr__(self) -> str:
        return f"Player({self._words})"

    def _repr_html_(self) -> str:
        how = 'title="Episode" width="100%" height="720" style="border:0" sandbox="allow-scripts"'
        return f'<iframe srcdoc="{escape(self._page)}" {how}></iframe>'
