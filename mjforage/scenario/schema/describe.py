"""A schema in rows: for `--explain`, and for the reference pages of the docs."""

import difflib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from mjforage.base.errors import UserError
from mjforage.scenario.schema import nodes
from mjforage.scenario.schema.adapters import Tree, json_schema

NAME = "NAME"  # stands for any name in a key: `team.NAME.radius`
_REQUIRED = "required"
_STATES = (_REQUIRED, "absent", "")  # what stands for a default where there is none


@dataclass(frozen=True)
class Row:
    """One key of a file."""

    key: str  # as a person writes it: `weather.gust_tau_s`, `team.NAME.radius`
    type: str
    unit: str
    range: str  # or the words that a text can be
    default: str
    sentence: str
    source: str
    table: bool  # whether it has keys of its own

    @property
    def words(self) -> str:
        """All but the key, in a line."""
        unit = f" [{self.unit}]" if self.unit else ""
        default = f"default {self.default}" if self.default not in _STATES else self.default
        head = ", ".join(part for part in (self.type + unit, self.range, default) if part)
        source = f" ({self.source})" if self.source else ""
        return f"{head}: {self.sentence}{source}" if self.sentence else head


def rows(schema: Any) -> list[Row]:
    """Every key of a schema, tables before their keys, in the order of the fields."""
    root = json_schema(schema)
    return list(_rows(root, root, ""))


def _rows(node: Tree, root: Tree, prefix: str) -> Iterator[Row]:
    required = node.get("required", ())
    for name, entry in node.get("properties", {}).items():
        found = nodes.resolved(entry, root)
        yield _row(found, prefix + name, name in required)
        yield from _inside(found, root, f"{prefix}{name}.")
        entries = nodes.resolved(found.get("items", {}), root)
        if entries.get("properties"):
            yield _row(entries, f"{prefix}{name}[]", False)
            yield from _inside(entries, root, f"{prefix}{name}[].")
    if isinstance(node.get("additionalProperties"), dict):
        entry = nodes.resolved(node["additionalProperties"], root)
        yield replace(_row(entry, prefix + NAME, False), default="")
        yield from _inside(entry, root, f"{prefix}{NAME}.")


def _inside(node: Tree, root: Tree, prefix: str) -> Iterator[Row]:
    """Rows of a table's keys, of all its kinds; a quantity is one key."""
    if nodes.is_quantity(node):
        return
    for one in nodes.kinds(node).values():
        yield from sorted(_rows(nodes.resolved(one, root), root, prefix), key=_is_not_kind)
    yield from _rows(node, root, prefix)


def _is_not_kind(row: Row) -> bool:
    return not row.key.endswith(".kind")


def _is_table(node: Tree) -> bool:
    plain = node.get("type") == "object" and not nodes.is_quantity(node)
    return "discriminator" in node or plain


def _row(node: Tree, key: str, required: bool) -> Row:
    about = nodes.number(node)
    words = nodes.choices(node)
    default = _REQUIRED if required else _default(node)
    return Row(
        key,
        nodes.type_words(about, key),
        str(about.get("unit", "")),
        " or ".join(map(str, words)) or nodes.range_words(node),
        "" if _is_table(node) and not required else default,
        " ".join(str(node.get("description", "")).split()),
        str(node.get("source", "")),
        _is_table(node),
    )


def _default(node: Tree) -> str:
    value = node.get("default")
    if value is None:
        return "absent"
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else str(value)


def explain(schema: Any, key: str) -> list[Row]:
    """The row of a key, and those in it if it is a table; a team's name stands for any.

    Raises `UserError` if there is no such key, with the nearest one.
    """
    root = json_schema(schema)
    place, node, prefix = [], root, ""
    for part in key.split("."):
        others = isinstance(node.get("additionalProperties"), dict)
        named = part in node.get("properties", {})
        if not named and not others:
            known = [prefix + name for name in node.get("properties", {})]
            close = difflib.get_close_matches(prefix + part, known, n=1, cutoff=0.5)
            hint = f"did you mean {close[0]}?" if close else f"known: {', '.join(known) or 'none'}"
            raise UserError(f"unknown key {prefix}{part}; {hint}")
        place.append(part if named else NAME)
        node = nodes.step(node, part, root)
        prefix += f"{part}."
    found = ".".join(place)
    return [
        replace(row, key=key + row.key.removeprefix(found))
        for row in rows(schema)
        if row.key == found or row.key.startswith(f"{found}.")
    ]


def page(schema: Any) -> str:
    """The schema as Markdown: a table of keys for every table of the file."""
    found = rows(schema)
    top = [row for row in found if "." not in row.key]
    parts = [_section("", [row for row in top if not row.table])]
    for table in (row for row in found if row.table):
        inside = [r for r in found if r.key.rpartition(".")[0] == table.key and not r.table]
        parts.append(_section(f"## `{table.key}`\n\n{table.sentence}".strip() + "\n", inside))
    return "\n".join(part for part in parts if part)


def _section(head: str, keys: list[Row]) -> str:
    if not keys:
        return head
    lines = ["| key | type | range | default | meaning |", "|---|---|---|---|---|"]
    for row in keys:
        unit = f" [{row.unit}]" if row.unit else ""
        meaning = f"{row.sentence} ({row.source})" if row.source else row.sentence
        name = row.key.rpartition(".")[2]
        cells = (f"`{name}`", row.type + unit, row.range, row.default, meaning)
        lines.append("| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |")
    return "\n".join([head, *lines, ""]).lstrip("\n")
