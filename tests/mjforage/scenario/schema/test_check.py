import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Annotated, Any, Literal

import pytest

from mjforage.base.errors import UserError
from mjforage.base.fields import Above, Within, source
from mjforage.scenario.schema import (
    OPEN,
    NotInFile,
    check,
    check_fields,
    explain,
    json_schema,
    page,
    rows,
)


@dataclass(frozen=True)
class Mast:
    """Carrier of the sails."""

    height_m: Annotated[float, Above(0, 50, "m"), source("survey")]
    """Above the deck."""
    stays: Annotated[int, Within(0, 8)] = 2


@dataclass(frozen=True)
class Boat:
    """A boat."""

    name: Annotated[str, NotInFile()]
    masts: Mapping[str, Mast]
    """By name."""
    rig: Literal["sloop", "ketch"] = "sloop"
    port: tuple[int, int] | None = None
    keel: Mast | None = None
    spare: tuple[str, ...] = ()
    notes: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    fast: bool = False


@dataclass(frozen=True)
class Record:
    """Output of a run."""

    __pydantic_config__ = OPEN
    count: int


MASTS = {"main": {"height_m": 9}}


def error_of(tree: object) -> str:
    with pytest.raises(UserError) as caught:
        check(Boat, tree, "boat x", name="x")
    return str(caught.value)


def test_a_tree_becomes_the_frozen_dataclass_and_integers_become_floats() -> None:
    boat = check(Boat, {"masts": MASTS, "port": [1, 2]}, "boat x", name="x")
    assert boat == Boat("x", {"main": Mast(9.0)}, port=(1, 2))
    assert type(boat.masts["main"].height_m) is float
    with pytest.raises(TypeError):
        boat.masts["mizzen"] = Mast(1.0)  # type: ignore[index]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"masst": 1}, "unknown key masst; did you mean masts?"),
        ({"qqq": 1}, "unknown key qqq; known: masts, rig, port, keel, spare, notes, fast"),
        ({"name": "y"}, "unknown key name; known: masts"),
        ({"rig": "slop"}, "rig = 'slop' should be 'sloop' or 'ketch'"),
        ({"rig": 3}, "rig = 3 should be 'sloop' or 'ketch'"),
        ({"masts": {"main": {}}}, "missing masts.main.height_m; add it"),
        ({"masts": {"main": {"height_m": 0}}}, "masts.main.height_m = 0 should be "),
        ({"masts": {"main": {"height_m": math.inf}}}, "masts.main.height_m = inf should be "),
        ({"masts": {"main": {"height_m": -(10**400)}}}, "0... should be a valid number"),
        (
            {"masts": {"main": {"height_m": "9"}}},
            "masts.main.height_m = '9' should be a valid number",
        ),
        ({"masts": {"main": {"height_m": 9, "stay": 1}}}, "unknown key masts.main.stay; did you"),
        (
            {"masts": {"main": {"height_m": 9, "stays": 2.0}}},
            "stays = 2.0 should be a valid integer",
        ),
        ({"masts": 3}, "masts = 3 should be a table"),
        ({"keel": 3}, "keel = 3 should be a table"),
        ({"port": [1]}, "port[1] = [1]: Field required"),
        ({"port": [1, 2, 3]}, "port = [1, 2, 3]: Tuple should have at most 2 items"),
        ({"port": [1, True]}, "port[1] = True should be a valid integer"),
        ({"spare": ["a", 2]}, "spare[1] = 2 should be text"),
        ({"spare": "a"}, "spare = 'a' should be a list"),
        ({"notes": {"a": 1}}, "notes.a = 1 should be text"),
        ({"fast": 1}, "fast = 1 should be true or false"),
    ],
)
def test_what_does_not_fit_is_one_line(change: dict[str, Any], words: str) -> None:
    message = error_of({"masts": MASTS} | change)
    assert message.startswith("boat x: ")
    assert words in message
    assert len(message) < 160


def test_what_is_no_table_and_what_is_nested_deeply_is_named() -> None:
    assert error_of([]) == "boat x: what it holds should be a table"
    deep: list[Any] = []
    for _ in range(100_000):
        deep = [deep]
    assert "rig = nested too deeply should be 'sloop'" in error_of({"masts": MASTS, "rig": deep})


def test_unknown_keys_are_named_before_missing_ones_before_values() -> None:
    tree: dict[str, Any] = {"rig": 3, "masts": {"main": {"stais": 1}}}
    assert "unknown key masts.main.stais" in error_of(tree)
    del tree["masts"]["main"]["stais"]
    assert "missing masts.main.height_m" in error_of(tree)


def test_a_record_takes_the_keys_of_newer_versions_and_names_its_remedy() -> None:
    assert check(Record, {"count": 1, "more": 2}, "run.json") == Record(1)
    with pytest.raises(UserError, match=r"run.json: count = 'a' should be a valid integer; again$"):
        check(Record, {"count": "a"}, "run.json", remedy="again")


def test_an_instance_made_by_code_is_checked_too() -> None:
    mast = Mast(3)
    check_fields(mast, "mast")
    assert type(mast.height_m) is float
    with pytest.raises(UserError, match="mast: stays = 9 should be "):
        check_fields(Mast(1.0, stays=9), "mast")


def test_rows_say_unit_range_default_sentence_and_source() -> None:
    found = {row.key: row for row in rows(Boat)}
    height = found["masts.NAME.height_m"]
    assert (height.type, height.unit, height.range) == ("a number", "m", "above 0 to 50")
    assert (height.default, height.sentence) == ("required", "Above the deck.")
    assert height.source == "survey"
    assert (found["rig"].range, found["rig"].default) == ("sloop or ketch", '"sloop"')
    assert found["fast"].default == "false"
    assert "name" not in found


def test_a_key_is_explained_and_a_table_with_all_its_keys() -> None:
    assert [row.key for row in explain(Boat, "masts.main.stays")] == ["masts.main.stays"]
    assert [row.key for row in explain(Boat, "keel")] == ["keel", "keel.height_m", "keel.stays"]
    with pytest.raises(UserError, match=r"unknown key masts.main.stay; did you mean masts.main.st"):
        explain(Boat, "masts.main.stay")
    with pytest.raises(UserError, match=r"unknown key rig.x; known: none"):
        explain(Boat, "rig.x")


def test_the_page_has_a_table_of_keys_for_every_table() -> None:
    text = page(Boat)
    assert "## `masts.NAME`" in text
    assert (
        "| `height_m` | a number [m] | above 0 to 50 | required | Above the deck. (survey) |"
        in text
    )


def test_the_json_schema_refuses_other_keys() -> None:
    found = json_schema(Boat)
    assert found["additionalProperties"] is False
    assert found["required"] == ["masts"]
    assert found["$defs"]["Mast"]["properties"]["height_m"]["exclusiveMinimum"] == 0
