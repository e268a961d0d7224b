"""Reader of a JSON Schema: the node of a key, and its type, range and unit in words."""

from collections.abc import Iterable
from typing import Any

from mjforage.scenario.schema.adapters import Tree

_TYPES = {
    "integer": "an integer",
    "number": "a number",
    "boolean": "true or false",
    "string": "text",
    "array": "a list",
    "object": "a table",
}


def resolved(node: Tree, root: Tree) -> Tree:
    """The node behind a reference or an optional, with the keys beside it."""
    beside = {key: value for key, value in node.items() if key not in ("$ref", "anyOf")}
    if "$ref" in node:
        return {**root["$defs"][node["$ref"].rpartition("/")[2]], **beside}
    some = [entry for entry in node.get("anyOf", ()) if entry != {"type": "null"}]
    return {**resolved(some[0], root), **beside} if len(some) == 1 else node


def kinds(node: Tree) -> dict[str, Tree]:
    """Name of each kind of a table that has several -> a reference to it, in their order."""
    mapping = node.get("discriminator", {}).get("mapping", {})
    names = {reference: name for name, reference in mapping.items()}
    return {names[entry["$ref"]]: entry for entry in node.get("oneOf", ()) if mapping}


def step(node: Tree, part: str | int, root: Tree) -> Tree:
    """The node of a key or index of a resolved node; empty where anything goes."""
    if isinstance(part, int):
        items = node.get("prefixItems")
        found = items[part] if items and part < len(items) else node.get("items", {})
    else:
        others = node.get("additionalProperties")
        found = node.get("properties", {}).get(part, others if isinstance(others, dict) else {})
    return resolved(found, root)


def find(root: Tree, location: Iterable[str | int]) -> tuple[Tree, str]:
    """The node at an error's location, and the key as a person writes it."""
    node, key = root, ""
    for part in location:
        if part in kinds(node):  # which kind it is, no key of the file
            node = resolved(kinds(node)[str(part)], root)
            continue
        node = step(node, part, root)
        key += f"[{part}]" if isinstance(part, int) else f".{part}"
    return node, key.removeprefix(".")


def number(node: Tree) -> Tree:
    """The node that has the range: a number with unit and source is a table around it."""
    entries: Tree = node.get("properties", {})
    found: Tree = entries["value"] if set(entries) == {"value", "unit", "source"} else node
    return found


def is_quantity(node: Tree) -> bool:
    """True if a number stands in a table with its unit and source."""
    return number(node) is not node


def range_words(node: Tree) -> str:
    """The range of a number, `0 to 10` or `above 0 to 10`, or the length of a list, or nothing."""
    about = number(node)
    if "minItems" in node and "prefixItems" not in node:
        return f"{node['minItems']} or more"
    low, high = about.get("minimum"), about.get("maximum")
    if "exclusiveMinimum" in about:
        return f"above {about['exclusiveMinimum']:g} to {high:g}"
    return "" if low is None or high is None else f"{low:g} to {high:g}"


def choices(node: Tree) -> list[Any]:
    """The words that a text can be."""
    found: list[Any] = node.get("enum") or ([node["const"]] if "const" in node else [])
    return found


def type_words(node: Tree, key: str = "") -> str:
    """Type of a key's value in words: `a number`, `a list`, ..."""
    if is_quantity(node):
        return "a number with unit and source"
    if isinstance(node.get("additionalProperties"), dict):
        return f"tables such as [{key or '...'}.NAME]" if _of_tables(node) else "a table"
    if "discriminator" in node:
        return "a table"
    some = node.get("type", "")
    names = some if isinstance(some, list) else [some]
    return " or ".join(_TYPES.get(name, "something else") for name in names)


def _of_tables(node: Tree) -> bool:
    entry = node["additionalProperties"]
    return "$ref" in entry or entry.get("type") == "object"
