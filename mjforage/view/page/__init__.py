"""One HTML page with everything inside it: what reports, studies and validation are set with."""

from mjforage.view.page.html import Shown, embedded, set_page
from mjforage.view.page.table import Number, Row, Table, groups

__all__ = [
    "Number",
    "Row",
    "Shown",
    "Table",
    "embedded",
    "groups",
    "set_page",
]
