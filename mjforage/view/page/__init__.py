"""One HTML page with everything inside it: what reports, studies and validation are set with."""

from mjforage.view.page.html import EmbeddedFigure, embedded_within, render_page
from mjforage.view.page.table import Number, Row, Table, groups

__all__ = [
    "EmbeddedFigure",
    "Number",
    "Row",
    "Table",
    "embedded_within",
    "groups",
    "render_page",
]
