"""Numbers of vessel and debris files: `{ value = 1.0, unit = "m", source = "where it is from" }`.

Strict: another unit, or no source, is an error. In the dataclass the field is the value alone.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from annotated_types import Ge, GroupedMetadata, Gt, Le
from pydantic_core import PydanticCustomError
from pydantic_core.core_schema import no_info_wrap_validator_function

from mjforage.base.fields import Handler, JsonSchema, Note
from mjforage.scenario.schema import shown

_ENTRY = ("source", "unit", "value")


@dataclass(frozen=True)
class _Sourced:
    """Reads a number from its table of value, unit and source."""

    unit: str

    def __get_pydantic_core_schema__(self, kind: Any, handler: Handler) -> Any:
        return no_info_wrap_validator_function(self._read, handler(kind))

    def __get_pydantic_json_schema__(self, core: object, handler: Handler) -> JsonSchema:
        number = handler(core)
        text = {"type": "string", "pattern": r"\S"}
        return {
            "type": "object",
            "properties": {"value": number, "unit": {"const": self.unit}, "source": text},
            "required": ["value", "unit", "source"],
            "additionalProperties": False,
        }

    def _read(self, entry: object, number: Handler) -> object:
        if not isinstance(entry, dict):
            raise _fault(f" = {shown(entry)}, expected a table of value, unit and source")
        if tuple(sorted(entry)) != _ENTRY:
            raise _fault(f" has {', '.join(entry) or 'nothing'}; give value, unit and source")
        value, unit, source = (entry[name] for name in ("value", "unit", "source"))
        if unit != self.unit:
            raise _fault(f' has unit {shown(unit)}, expected "{self.unit}"')
        if not isinstance(source, str) or not source.strip():
            raise _fault(f" has no source; say where {shown(value)} is from")
        return number(value)


def _fault(words: str) -> PydanticCustomError:
    return PydanticCustomError("words", "{words}", {"words": words})


@dataclass(frozen=True)
class Quantity(GroupedMetadata):
    """Unit and range of a number that its file gives with unit and source."""

    unit: str
    low: float
    high: float
    above: bool = False  # whether `low` itself is out of range

    def __iter__(self) -> Iterator[object]:
        yield (Gt if self.above else Ge)(self.low)
        yield from (Le(self.high), Note("unit", self.unit), _Sourced(self.unit))


def positive(unit: str, high: float) -> Quantity:
    """A number above 0."""
    return Quantity(unit, 0.0, high, above=True)
