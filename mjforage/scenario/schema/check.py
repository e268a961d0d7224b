"""Plain values against a schema: the dataclass, or one line that names key, value and remedy."""

import dataclasses
import difflib
from collections.abc import Hashable, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeVar, get_type_hints

from mjforage.base.errors import UserError
from mjforage.scenario.schema import nodes
from mjforage.scenario.schema.adapters import Tree, json_schema, validator

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

_T = TypeVar("_T")

_LONGEST = 60  # characters of a value in a message
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

    Parameters
    ----------
    schema : a frozen dataclass
    tree : as read from TOML or JSON
    where : what errors name first; may be empty
    remedy : what errors name last, for files that nobody writes by hand
    given : fields that are no keys of the file (`NotInFile`)

    Raises
    ------
    UserError
        For an unknown or missing key, a wrong type or a value out of range.
    """
    if isinstance(tree, Mapping):
        for key in given.keys() & tree.keys():
            raise UserError(_line(where, _unknown(schema, (key,)), remedy))
        tree = {**tree, **given}
    found: _T = _checked(schema, tree, where, remedy)
    return found


def check_fields(instance: Any, where: str) -> None:
    """Check a dataclass that code makes, from its `__post_init__`; integers become floats.

    Raises
    ------
    UserError
        As `check`.
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
        return _missing(root, missing, remedy)
    fault = faults[0]
    location = fault["loc"][1:-1] if fault["type"] == "missing" else fault["loc"][1:]
    node, key = nodes.find(root, location)
    if fault["type"].startswith("union_tag"):
        value = fault["input"].get(fault["ctx"]["discriminator"].strip("'"), "")
        return f"{key}.kind = {shown(value)}; choose {', '.join(nodes.kinds(node))}"
    if fault["type"] == "words":  # of a validator of ours
        return f"{key}{fault['msg']}"
    if not key:
        return f"expected {nodes.type_words(node)}"
    return f"{key} = {shown(fault['input'])}{_fault(node, key, fault['input'])}"


def _is_key(location: tuple[str | int, ...]) -> bool:
    return isinstance(location[-1], str)


def _unknown(schema: Any, location: tuple[str | int, ...]) -> str:
    *above, last = location
    root = json_schema(schema)
    node, key = nodes.find(root, above)
    known, prefix = list(node.get("properties", ())), f"{key}." if key else ""
    close = difflib.get_close_matches(str(last), known, n=1, cutoff=0.6)
    hint = f"did you mean {prefix}{close[0]}?" if close else f"known: {', '.join(known)}"
    return f"unknown key {prefix}{last}; {_of_other_kind(root, above, str(last)) or hint}"


def _of_other_kind(root: Tree, above: list[str | int], last: str) -> str:
    """Which kind of a table that has several has a key that the kind at `above` has not."""
    table, _ = nodes.find(root, above[:-1])
    for kind, entry in nodes.kinds(table).items():
        if last in nodes.resolved(entry, root)["properties"]:
            return f"it is one of kind = {shown(kind)}, and the kind is {shown(above[-1])}"
    return ""


def _missing(root: Tree, locations: list[tuple[str | int, ...]], remedy: str) -> str:
    found = [nodes.find(root, location) for location in locations]
    names = ", ".join(key for _, key in found)
    if remedy:
        return f"missing {names}"
    if len(found) > 1:
        return f"missing {names}; add them"
    node, key = found[0]
    unit = nodes.number(node).get("unit")
    bracket = f" [{unit}]" if unit else ""
    return f"missing {names}; add it, {nodes.type_words(node, key)}{bracket}"


def _fault(node: Tree, key: str, value: object) -> str:
    """What is wrong with a value, by what its node asks for."""
    kind, words = node.get("type"), nodes.choices(node)
    if words and isinstance(value, str):
        return f"; choose {', '.join(map(str, words))}"
    about = nodes.number(node)
    numbers = (int,) if about.get("type") == "integer" else (int, float)
    is_number = about.get("type") in ("integer", "number")
    if is_number and isinstance(value, numbers) and not isinstance(value, bool):
        return f" is out of range; give {nodes.range_words(node) or 'a finite number'}"
    if is_number:
        return f", expected {nodes.type_words(about)}"
    if kind == "array" and isinstance(value, list | tuple):
        some = len(node["prefixItems"]) if "prefixItems" in node else nodes.range_words(node)
        return f", expected {some} values"
    return f", expected {nodes.type_words(node, key)}"
