"""Exports from the command line."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.mjforage.cli.short_runs import Refused

pytestmark = pytest.mark.usefixtures("here")
FILES = {"README.md", "scene.xml", "tracks.csv"}


def test_a_scenario_and_a_run_are_exported(command: Callable[..., Any], folder: Path) -> None:
    for source, options, frames in (
        ("comb-port", ("--seed", 4, "--set", "team.scouts.count=1"), 1),
        (folder, ("--episode", 1, "--policy", "lawnmower"), 9),
    ):
        target = Path("out") / str(frames)
        done = command("export", source, "--to", "mjcf", "-o", target, *options)
        assert (done.code, done.out) == (0, f"export: {target}\n")
        assert {path.name for path in target.iterdir()} == FILES
        vessels = 4 if source == folder else 3
        lines = (target / "tracks.csv").read_text("utf-8").splitlines()
        assert len(lines) == 1 + vessels * frames
    words = (target / "README.md").read_text("utf-8")
    assert "episode 1 of seed 0, lawnmower in world graph" in words


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["comb-port", "--to", "mcjf"], "format mcjf: unknown; did you mean mjcf?"),
        (
            ["comb-port", "--to", "geojson"],
            "format geojson: needs latitude and longitude; map comb",
        ),
        (["comb-port", "--to", "mjcf", "--world", "graph"], "--world: is for the export of a run"),
        (["RUN", "--to", "mjcf", "--seed", 1], "--seed: is for the export of a scenario"),
        (["RUN", "--to", "mjcf", "--episode", 2], "episode 2: give 0 to 1"),
        (["comb-port", "--to", "mjcf", "--episode", -1], "episode -1: give"),
        (["comb-port", "--to", "mjcf", "--episode", 2**63], "episode 9223372036854775808: give"),
        (
            ["comb-port", "--to", "mjcf", "--set", "map.pitch_m=1"],
            "vessel forager: a vessel of 2 m x 1.08 m needs 2.27 m to turn",
        ),
        (["moon", "--to", "mjcf"], "scenario moon: neither a shipped scenario nor a TOML file"),
    ],
)
def test_an_export_that_cannot_be_made_is_one_line(
    arguments: list[object], words: str, refused: Refused, reported: tuple[Path, list[str]]
) -> None:
    given = [reported[0] if one == "RUN" else one for one in arguments]
    assert words in refused("export", *given, "-o", "out")
    assert not Path("out").exists()
