"""pydantic's adapters of a schema: the strict validator and the JSON Schema.

pydantic is imported where a file is read or described, not with the package: it takes 0.2 s.
"""

from dataclasses import dataclass, is_dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from mjforage.base.fields import Handler

if TYPE_CHECKING:
    from pydantic import TypeAdapter
    from pydantic_core import SchemaValidator

Tree = dict[str, Any]

_CONFIG = {"extra": "forbid", "allow_inf_nan": False, "use_attribute_docstrings": True}
OPEN = _CONFIG | {"extra": "ignore"}
"""`__pydantic_config__` of a table that a newer version may write more keys into."""

_SCALARS = ("int", "float", "bool", "str")


@dataclass(frozen=True)
class NotInFile:
    """Mark of a field that is no key of the file, such as a name taken from the file's name."""

    def __get_pydantic_json_schema__(self, core: object, handler: Handler) -> Tree:
        """Leave the field out."""
        from pydantic_core import PydanticOmit

        raise PydanticOmit


@lru_cache(maxsize=64)
def _adapter(schema: Any) -> "TypeAdapter[Any]":
    """Adapter of a list of one: pydantic takes no configuration for a dataclass by itself."""
    from pydantic import TypeAdapter

    return TypeAdapter(list[schema], config=_CONFIG)  # type: ignore[arg-type]


@lru_cache(maxsize=64)
def validator(schema: Any) -> "SchemaValidator":
    """Validator of a list of one tree of the schema."""
    from pydantic_core import SchemaValidator

    return SchemaValidator(_strict(_adapter(schema).core_schema))


def _strict(node: Any) -> Any:
    """The same core schema, in which no scalar is converted and mappings are read-only.

    A mapping of anything stays a plain one, to be shown or written again.

    pydantic's own strictness would also want instances of the dataclasses instead of tables.
    """
    from pydantic_core import core_schema

    if isinstance(node, list):
        return [_strict(entry) for entry in node]
    if not isinstance(node, dict):
        return node
    found = {key: value if key == "default" else _strict(value) for key, value in node.items()}
    kind = found.get("type")
    if isinstance(kind, str):
        found["strict"] = kind in _SCALARS
    if kind == "dict" and found["values_schema"]["type"] != "any":
        return core_schema.no_info_after_validator_function(MappingProxyType, found)
    if kind == "tagged-union":
        return core_schema.no_info_before_validator_function(_with_text_kind, found)
    return found


def _with_text_kind(entry: object) -> object:
    """A table whose kind is a text: pydantic prints any other, which may have no end."""
    if isinstance(entry, dict) and not isinstance(entry.get("kind", ""), str):
        return entry | {"kind": ""}
    return entry


@lru_cache(maxsize=64)
def json_schema(schema: Any) -> Tree:
    """JSON Schema (2020-12) of a schema, tables under `$defs`.

    Units and sources stand beside the ranges, under `unit` and `source`.
    """
    from pydantic.json_schema import GenerateJsonSchema

    class Untitled(GenerateJsonSchema):
        """Keys speak for themselves."""

        def field_title_should_be_set(self, schema: Any) -> bool:
            return False

    found = _adapter(schema).json_schema(schema_generator=Untitled)
    tables = found.get("$defs", {})
    root: Tree = found["items"]
    if "$ref" in root:
        root = tables.pop(root["$ref"].rpartition("/")[2])
    _inherit(schema, root.get("properties", {}))
    return root | ({"$defs": tables} if tables else {})


def _inherit(schema: Any, fields: Tree) -> None:
    """Add the sentences of fields that a base has: pydantic reads those of the class alone."""
    bases: list[Any] = [each for each in getattr(schema, "__mro__", ())[1:] if is_dataclass(each)]
    for base in bases:
        for name, field in json_schema(base)["properties"].items():
            if "description" in field:
                fields[name].setdefault("description", field["description"])
