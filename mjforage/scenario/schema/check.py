"""Plain values against a schema: the dataclass, or one line that names key, value and remedy."""

import dataclasses
import difflib
from collections.abc import Hashable, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeVar, get_type_hints

from mjforage.base.errors import UserError
from mjforage.scenario.schema import nodes
from mjforage.scenario.schema.adapters import json_schema, validator

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

_T = TypeVar("_T")

_LONGEST = 60  # characters of a value in a message
_TABLES = {
    **dict.fromkeys(("dataclass_type", "dict_type"), "a table"),
    "tuple_type": "a list",
    "bool_type": "true or false",
    "string_type": "text",
}
"""Types of TOML and JSON, where pydantic has Python's."""
_UNKNOWN = ("unexpected_keyword_argument", "extra_forbidden", "invalid_key")


def shown(value: object) -> str:
    """A value as a message shows it, also one that Python refuses to print."""
    try:
        text = repr(value)
    except ValueError:
        return "a number of thousands of digits"
    except RecursionError:
        return "nested too deeply"
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def check(schema: type[_T], tree: object, where: str, *, remedy: str = "", **given: Any) -> _T:
    """The instance that a tree describes.

    Raises `UserError` for an unknown or missing key, a wrong type or a value out of range.

    Parameters
    ----------
    schema : a frozen dataclass
    tree : as read from TOML or JSON
    where : start of error messages; may be empty
    remedy : end of the messages, for files that are not written by hand
    given : fields that are no keys of the file (`NotInFile`)
    """
    if isinstance(tree, Mapping):
        for key in given.keys() & tree.keys():
            raise UserError(_line(where, _unknown(schema, (key,)), remedy))
        tree = {**tree, **given}
    found: _T = _checked(schema, tree, where, remedy)
    return found


def check_fields(instance: Any, where: str) -> None:
    """Check a dataclass that code makes, from its `__post_init__`; integers become floats.

    Raises `UserError` as `check`.
    """
    fields = {f.name: getattr(instance, f.name) for f in dataclasses.fields(instance)}
    schema: Any = type(instance)
    checked = _checked(_typed(schema), fields, where, "")
    for name, value in checked.items():
        object.__setattr__(instance, name, value)


@lru_cache(maxsize=64)
def _typed(schema: Hashable) -> Any:
    """The fields of a dataclass as a typed dictionary, so that to check them makes no instance."""
    from typing_extensions import TypedDict

    make: Any = TypedDict
    return make("Fields", get_type_hints(schema, include_extras=True))


def _checked(schema: Any, tree: object, where: str, remedy: str) -> Any:
    from pydantic_core import ValidationError

    try:
        (found,) = validator(schema).validate_python([tree])
    except ValidationError as error:
        faults = error.errors(include_url=False)
    else:
        return found
    raise UserError(_line(where, _first(schema, faults, remedy), remedy))


def _line(where: str, words: str, remedy: str) -> str:
    return "".join((f"{where}: " if where else "", words, f"; {remedy}" if remedy else ""))


def _first(schema: Any, faults: "list[ErrorDetails]", remedy: str) -> str:
    """The fault that explains most: unknown keys before missing ones before values."""
    for fault in faults:
        if fault["type"] in _UNKNOWN:
            return _unknown(schema, fault["loc"][1:])
    root = json_schema(schema)
    missing = [f["loc"][1:] for f in faults if f["type"] == "missing" and _is_key(f["loc"])]
    if missing:
        names = [nodes.find(root, location)[1] for location in missing]
        add = "" if remedy else "; add them" if names[1:] else "; add it"
        return f"missing {', '.join(names)}{add}"
    fault = faults[0]
    node, key = nodes.find(root, fault["loc"][1:])
    if fault["type"] == "words":  # of a validator of ours
        return f"{key}{fault['msg']}"
    if fault["type"].startswith("union_tag"):
        kind = fault["input"].get("kind", "")
        return f"{key}.kind = {shown(kind)}; choose {', '.join(nodes.kinds(node))}"
    should = _TABLES.get(fault["type"]) or fault["msg"].partition("Input should be ")[2]
    value = f"{key} = {shown(fault['input'])}" if key else "what it holds"
    return f"{value} should be {should}" if should else f"{value}: {fault['msg']}"


def _is_key(location: tuple[str | int, ...]) -> bool:
    return isinstance(location[-1], str)


def _unknown(schema: Any, location: tuple[str | int, ...]) -> str:
    *above, last = location
    root = json_schema(schema)
    node, key = nodes.find(root, above)
    known, prefix = list(node.get("properties", ())), f"{key}." if key else ""
    close = difflib.get_close_matches(str(last), known, n=1, cutoff=0.6)
    hint = f"did you mean {prefix}{close[0]}?" if close else f"known: {', '.join(known)}"
    return f"unknown key {prefix}{last}; {hint}"
