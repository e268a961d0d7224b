"""Maps given to commands: drawn, refused, mended, generated."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from mjforage.scenario.maps import load_map
from tests.mjforage.cli.short_runs import Refused

pytestmark = pytest.mark.usefixtures("here")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("1,1\n1\n1,1\n", "map port.csv: row 1 has 1 columns, expected 2"),
        ("", "map port.csv: is empty"),
        ("0,0\n0,0\n", "map port.csv: all 4 cells are obstacles"),
        (
            "1,0,1\n1,0,1\n",
            "form 2 separate components, of 2, 2 nodes; keep only that one "
            "where you play on it: give map.largest_component = true",
        ),
        ("1,0\n0,1\n", "or join them with map.corner_cutting = true"),
        ("1,2\n", "row 0, column 1 is '2', expected 0 or 1"),
        ("1,1\n", "4 agents do not fit on a map of 2 nodes"),
        ("0,0,0\n1,1,1\n1,1,1\n", "start (0, 0) of scenario channels is on land"),
        ("1\n1\n1\n1\n1\n1\n", "start (0, 1) of scenario channels is outside map"),
    ],
)
def test_a_map_that_cannot_be_used_is_one_line(
    content: str, words: str, refused: Refused, here: Path
) -> None:
    Path("port.csv").write_text(content)
    starts = ("--set", "map.starts=[[0,0],[0,1]]") if "start (" in words else ()
    arguments = ("evaluate", "channels", "--policy", "greedy", "--map", "port.csv", *starts)
    assert words in refused(*arguments)
    assert [path.name for path in here.iterdir()] == ["port.csv"]


def test_the_remedy_for_a_disconnected_map_works(
    command: Callable[..., Any],
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    monkeypatch.setattr(
        "mjforage.view.report.write_report", lambda folder, *_: folder / "report.html"
    )
    Path("port.csv").write_text("1,1,1,0,1\n1,1,1,0,1\n")
    arguments = (
        *("evaluate", "channels", "--policy", "greedy", "--map", "port.csv", "--episodes", 1),
        *("--set", "map.largest_component=true", "--set", "horizon=3"),
    )
    outcome = command(*arguments)
    assert outcome.code == 0
    assert "6 nodes" in outcome.out
    assert "2 of 8 nodes lie outside the largest of 2 components" in caplog.text


def test_one_map_is_checked_and_drawn(command: Callable[..., Any]) -> None:
    Path("port.csv").write_text("1,1\n1,0\n")
    outcome = command("maps", "port.csv", "-o", "port.png")
    assert (outcome.code, outcome.out) == (0, "port.csv: 2 x 2, 3 nodes\npicture: port.png\n")
    with Image.open("port.png") as image:
        assert image.width > 100


def test_generated_harbours_are_drawn_and_written(command: Callable[..., Any]) -> None:
    outcome = command("maps", "harbour:combs:7:30x44", "-o", "port.csv")
    assert outcome.code == 0
    again = command("maps", "port.csv")
    assert outcome.out.splitlines()[0].split(": ")[1] == again.out.strip().split(": ")[1]
    assert (load_map("port.csv").navigable == load_map("harbour:combs:7:30x44").navigable).all()
    assert len(command("maps", "harbours:0-6", "-o", "sheet.png").out.splitlines()) == 7 + 1
    with Image.open("sheet.png") as image:
        assert image.width > 400


def test_a_generated_harbour_is_a_map_like_any(
    command: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Starts of the scenario's own map do not hold there: they are drawn."""
    monkeypatch.setattr(
        "mjforage.view.report.write_report", lambda folder, *_: folder / "report.html"
    )
    outcome = command(
        *("evaluate", "comb-port", "--policy", "greedy", "--episodes", 1, "--out", "run"),
        *("--map", "harbour:bays:3:30x40", "--set", "horizon=3"),
    )
    assert (outcome.code, outcome.err) == (0, "")
    info = json.loads(Path("run/run.json").read_text())
    assert info["scenario"]["map"]["file"] == info["map"]["name"] == "harbour:bays:3:30x40"
    assert info["scenario"]["map"]["starts"] == []
    cells = load_map("harbour:bays:3:30x40").navigable
    assert info["map"]["navigable"] == ["".join("01"[int(c)] for c in row) for row in cells]


def test_an_image_with_dark_water_is_drawn_and_played(
    command: Callable[..., Any],
    refused: Refused,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    monkeypatch.setattr(
        "mjforage.view.report.write_report", lambda folder, *_: folder / "report.html"
    )
    chart = Image.new("L", (6, 5), 255)
    chart.paste(0, (1, 1, 5, 4))
    chart.save("chart.png")
    assert command("maps", "chart.png").out == "chart.png: 5 x 6, 18 nodes\n"
    assert "all of its edge is water; if that is the land, give map.water = dark" in caplog.text
    for dark in (("--water", "dark"), ("--set", "map.water=dark")):
        assert command("maps", "chart.png", *dark).out == "chart.png: 5 x 6, 12 nodes\n"
    for name in ("evaluate", "compare"):
        outcome = command(
            *(name, "channels", "--policy", "greedy", "--episodes", 1, "--set", "horizon=3"),
            *("--map", "chart.png", "--water", "dark"),
        )
        assert outcome.code == 0 and "12 nodes" in outcome.out
    assert "map comb_port: has light water" in refused("maps", "comb_port", "--water", "dark")
    assert "blue" in refused("maps", "chart.png", "--water", "blue")


def test_a_map_in_parts_is_drawn_by_the_rules_it_is_played_by(
    command: Callable[..., Any], refused: Refused
) -> None:
    Path("port.csv").write_text("1,1,0,0\n1,1,0,0\n0,0,1,0\n")
    assert "separate components" in refused("maps", "port.csv", "-o", "port.png")
    for rule, nodes in (("largest_component", 4), ("corner_cutting", 5)):
        outcome = command("maps", "port.csv", "--set", f"map.{rule}=true", "-o", "port.png")
        assert f"port.csv: 3 x 4, {nodes} nodes" in outcome.out
    words = refused("maps", "port.csv", "--set", "items.mean=3")
    assert "--set items.mean=3: gives a map no other nodes; give map.corner_cutting or" in words
    assert "corner_cutting = 'perhaps'" in refused(
        "maps", "port.csv", "--set", "map.corner_cutting=perhaps"
    )
