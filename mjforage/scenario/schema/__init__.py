"""One layer for every file that a person or a run writes: a schema is a frozen dataclass.

A field is a type, its range and unit (`mjforage.base.fields`) and a sentence, the docstring under
it. `check` reads plain values against it, `describe` says it in rows, `json_schema` for editors.
"""

from mjforage.scenario.schema.adapters import OPEN, NotInFile, json_schema
from mjforage.scenario.schema.check import check, check_fields, shown
from mjforage.scenario.schema.describe import NAME, Row, explain, page, rows

__all__ = [
    "NAME",
    "OPEN",
    "NotInFile",
    "Row",
    "check",
    "check_fields",
    "explain",
    "json_schema",
    "page",
    "rows",
    "shown",
]
