"""Marks on the fields of files, beside their types: range, unit, source.

`Annotated[float, Within(0, 1000, "node")]` on a dataclass; the sentence is the docstring under the
field. These are plain marks. `mjforage.scenario.schema` makes errors, schemas and reference pages
of them.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from annotated_types import Ge, GroupedMetadata, Gt, Le

JsonSchema = dict[str, Any]
Handler = Callable[[Any], Any]


@dataclass(frozen=True)
class Note:
    """A word about a field that pydantic hands on into the JSON Schema."""

    key: str  # of the JSON Schema
    words: str

    def __get_pydantic_json_schema__(self, core: object, handler: Handler) -> JsonSchema:
        """The field's JSON Schema, with the note."""
        found: JsonSchema = handler(core)
        return found | {self.key: self.words}


def source(words: str) -> Note:
    """Source of the default, or of the range."""
    return Note("source", words)


@dataclass(frozen=True)
class Within(GroupedMetadata):
    """The closed range of a number, and its unit."""

    low: float
    high: float
    unit: str = ""

    def __iter__(self) -> Iterator[object]:
        yield from (self._least(self.low), Le(self.high))
        if self.unit:
            yield Note("unit", self.unit)

    def _least(self, low: float) -> object:
        return Ge(low)


class Above(Within):
    """A number above `low`, up to `high`, and its unit."""

    def _least(self, low: float) -> object:
        return Gt(low)
