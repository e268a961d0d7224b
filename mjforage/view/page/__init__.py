"""One self-contained HTML page, for reports, studies and validation."""

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
