"""Scenarios that tests write, and what is said of them."""

from pathlib import Path

import pytest

from mjforage.base.errors import UserError
from mjforage.scenario.scenario_file import (
    load_scenario,
)

TEAMS = """
[team.pilots]
count = 1
moves = 3
radius = 6
collects = false

[team.skimmers]
count = 2
moves = 1
radius = 1.5
collects = true
capacity = 30
"""
MINIMAL = f'name = "mine"\n[map]\nfile = "open_bay"\n{TEAMS}'


def write(folder: Path, text: str) -> str:
    path = folder / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def error_of(reference: str, *overrides: str, map_file: str | None = None) -> str:
    with pytest.raises(UserError) as caught:
        load_scenario(reference, overrides, map_file)
    return str(caught.value)
