"""Shipped schemas are those that the command writes now, and our own files follow them."""

import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from mjforage.cli.schemas import schema_text, schemas_of_files
from mjforage.scenario.assets import models_folder
from mjforage.scenario.schema import NAME, rows
from mjforage.scenario.vessel_files import capture_path, vessel_names, vessel_path

MODELS = models_folder()
PAGES = MODELS.parent / "docs" / "reference"
FILES = [
    *(("scenario", path) for path in sorted((MODELS / "scenarios").glob("*.toml"))),
    *(("vessel", vessel_path(name)) for name in vessel_names()),
    ("capture", capture_path("forager")),
    ("debris", MODELS / "debris.toml"),
]


def shipped(name: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((MODELS / "schemas" / f"{name}.json").read_text())
    return found


def test_what_ships_is_what_the_command_writes_now(
    tmp_path: Path, command: Callable[..., Any]
) -> None:
    command("schemas", "--out", tmp_path / "schemas", "--pages", tmp_path / "pages")
    for made, there in ((tmp_path / "schemas", MODELS / "schemas"), (tmp_path / "pages", PAGES)):
        new, old = (
            {p.name: p.read_text() for p in folder.iterdir() if p.is_file() and p.stem != "index"}
            for folder in (made, there)
        )
        assert new == old, "run: mjforage schemas --out models/schemas --pages docs/reference"
        commands = {"command-line"} if there == PAGES else set()
        assert {name.split(".")[0] for name in new} == {*schemas_of_files()} | commands


@pytest.mark.parametrize("name", schemas_of_files())
def test_every_schema_is_one(name: str) -> None:
    jsonschema.Draft202012Validator.check_schema(shipped(name))
    assert schema_text(name, schemas_of_files()[name][1]).endswith("}\n")


@pytest.mark.parametrize(("name", "path"), FILES, ids=lambda value: getattr(value, "stem", value))
def test_our_files_follow_their_schema_and_tell_editors_of_it(name: str, path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    hint, separator, place = text.partition("\n")[0].partition(" ")
    assert (hint, separator) == ("#:schema", " ")
    assert (path.parent / place).resolve() == (MODELS / "schemas" / f"{name}.json").resolve()
    jsonschema.validate(tomllib.loads(text), shipped(name))


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("scenario", {"horzion": 3}),
        ("scenario", {"horizon": 0}),
        ("scenario", {"team": {"scouts": {"count": 1}}}),
        ("scenario", {"physics": {"capture": "net"}}),
        ("vessel", {"length_m": 2.0}),
        ("vessel", {"length_m": {"value": 2.0, "unit": "ft", "source": "x"}}),
        ("vessel", {"length_m": {"value": 0.0, "unit": "m", "source": "x"}}),
        ("vessel", {"thruster": {"kind": "sail"}}),
        ("debris", {"bottle": {"description": "x"}}),
        ("capture", {"period_s": 0.0}),
        ("capture", {"follows": [{"quays": "round", "trials": 2, "taken": 1}]}),
    ],
)
def test_a_schema_refuses_what_the_reader_refuses(name: str, change: dict[str, Any]) -> None:
    path = next(path for kind, path in FILES if kind == name)
    tree = tomllib.loads(path.read_text(encoding="utf-8")) | change
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(tree, shipped(name))


def test_a_key_of_a_scenario_is_explained_and_a_wrong_one_named(
    command: Callable[..., Any], refused: Callable[..., str]
) -> None:
    words = " ".join(command("scenarios", "--explain", "team.scouts.radius").out.split())
    assert words == "team.scouts.radius a number [node], 0 to 1000, required: Sensing radius."
    assert "weather.gust_tau_s" in command("scenarios", "--explain", "weather").out
    wrong = refused("scenarios", "--explain", "weather.gust_tau")
    assert "unknown key weather.gust_tau; did you mean weather.gust_tau_s?" in wrong


def test_every_key_that_a_person_writes_has_a_sentence() -> None:
    for name in ("scenario", "vessel", "debris"):
        for row in rows(schemas_of_files()[name][1]):
            assert row.sentence or row.key.endswith(NAME), f"{name}: {row.key}"
