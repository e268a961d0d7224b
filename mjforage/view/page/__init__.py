"""One HTML page with everything inside it: what reports, studies and validation are set with."""

from mjforage.view.page.html import Shown, embedded, embedded_within, set_page
from mjforage.view.page.table import Number, Row, Table, groups

__all__ = [
    "Number",
    "Row",
    "Shown",
    "Table",
    "embedded",
    "embedded_within",
    "groups",
    "set_page",
]
