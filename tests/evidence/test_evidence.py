"""Pages agree with the data of their evidence, and data come from commands."""

import json
import re
from collections import defaultdict
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage import metrics
from mjforage.base.references import with_options
from mjforage.cli.commands import app
from mjforage.graph_planner.policies.registry import policy_label
from mjforage.mission.scoring import METRICS, describe
from mjforage.scenario.scenario_file import load_scenario
from tests.documents.blocks import pages
from tests.evidence import __main__ as making
from tests.evidence import marks, playing, tables
from tests.evidence.cells import beside, interval, mean
from tests.evidence.marks import MARK, filled
from tests.evidence.page import names, region, renewed
from tests.evidence.piece import REPOSITORY, Cell, Column, Piece, Row, load, pieces, save
from tests.evidence.playing import Runs, place, plain
from tests.evidence.shown import shown

ALL = {name: load(name) for name in pieces()}
SMALL = "mjforage evaluate comb-port --policy greedy --policy levy --episodes 2 --set horizon=12"
PIECE = Piece(
    "small",
    {"": {"command": SMALL}},
    [Column("policy"), Column("PTA_C %", ".1f", {"key": "pta_c"})],
    [Row(["greedy", {}], {"policy": "greedy"}), Row(["of others", "98.6"])],
    {"way": "mean"},
)


@pytest.mark.parametrize("page", pages())
def test_regions_and_marks_are_what_their_data_say(page: str) -> None:
    text = (REPOSITORY / page).read_text("utf-8")
    assert text.count("\n<!-- evidence: ") == len(names(page))
    assert text.count("<!-- n:") == len(MARK.findall(text)) == text.count("<!-- /n -->")
    assert not re.search(r"^\s*<!-- /?n\b", text, re.M), "Markdown takes such a line for HTML"
    assert renewed(page, text) == text, "python -m tests.evidence --pages draws it"


@pytest.mark.parametrize(
    ("mark", "text"),
    [
        ("small | a; b | share#1", "0.98"),
        ("small | a; b | share#1 | low", "0.90"),
        ("small | a; b | share#1 | mean .0%", "98"),
        ("small | a; b | share#1 | n", "5,000"),
        ("small | a; b − c | share#2", "−0.200"),
        ("small | a; b − c | share#2 | -gap .1f", "0.2"),
        ("small | d; b − c | share#1 | half +.1f", "+0.3"),
    ],
)
def test_a_mark_is_filled_from_its_piece(
    mark: str, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    columns = [Column("*policy*"), Column("world"), Column("share", ".2f"), Column("share", ".3f")]
    rows = [
        Row(["`a`", "b", {"mean": 0.98, "low": 0.9, "n": 5000}, {}]),
        Row(["", "b − c", {}, {"gap": -0.2, "half": 0.1}]),
        Row(["[d](e.md)", "b − c", {"gap": 0.1, "half": 0.3}, {}]),
    ]
    monkeypatch.setattr(marks, "load", lambda name: Piece(name, {}, columns, rows))
    page = "It is <!-- n: {} -->{}<!-- /n --> of all."
    assert filled(page.format(mark, "0.5")) == page.format(mark, text)


@pytest.mark.parametrize(
    ("mark", "error"),
    [
        ("comb-port | nobody | PTA_C %", ValueError),
        ("comb-port | greedy | PTA", ValueError),
        ("comb-port | greedy | policy", ValueError),
        ("gap-brief | greedy | physics − graph", ValueError),
        ("comb-port | greedy | PTA_C % | width", KeyError),
    ],
)
def test_a_mark_without_a_number_is_refused(mark: str, error: type[Exception]) -> None:
    with pytest.raises(error):
        marks.number(mark)


def test_every_table_stands_on_a_page() -> None:
    drawn = {name for page in pages() for name in names(page)}
    assert drawn == {name for name, piece in ALL.items() if piece.columns}


def parsed(command: str) -> dict[str, Any]:
    _, bound, _ = app.parse_args(plain(command), exit_on_error=False, print_error=False)
    return bound.arguments


@cache
def played(command: str) -> list[str]:
    """Names of policies as their rows have them."""
    given = parsed(command)
    options = vars(given["choice"]) if given.get("choice") else given
    named, _ = with_options("policy", given["policy"], options.get("set", ()))
    return [policy_label(one) if "(" in one else one for one in named]


def test_settings_of_commands_are_of_scenarios() -> None:
    """A wrong one is refused here, not hours after the start."""
    commands = {run["command"] for piece in ALL.values() for run in piece.runs.values()}
    settings = set()
    for given in map(parsed, (one for one in commands if one.startswith("mjforage"))):
        if "scenario" in given and "courses" not in given:
            options = vars(given["choice"]) if given.get("choice") else given
            _, overrides = with_options("policy", given.get("policy", ()), options.get("set", ()))
            settings.add((given["scenario"], overrides, options.get("map")))
    assert len(settings) > 20
    for scenario, overrides, where in settings:
        load_scenario(scenario, overrides, where)


@pytest.mark.parametrize("name", [name for name in ALL if name not in tables.WHOLE])
def test_numbers_are_of_what_the_commands_play(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    piece = ALL[name]
    keys = {*METRICS.names()}

    def values(spec: dict[str, Any], runs: Runs) -> NDArray[np.float64]:
        assert spec["key"] in keys
        assert "variant" in spec or spec["policy"] in played(piece.runs[spec["run"]]["command"])
        return np.array([1.0, 2.0, 4.0])

    monkeypatch.setattr(tables, "values", values)
    monkeypatch.setattr(tables, "horizon", lambda spec, runs: 150)
    for way in set(tables.OTHERS) - {"mean"}:
        monkeypatch.setitem(tables.OTHERS, way, lambda spec, runs: {"mean": 1.0})
    rows = tables.made_rows(piece, Runs({}))
    for made, row in zip(rows, piece.rows, strict=True):
        assert [isinstance(cell, dict) for cell in made.cells] == [
            isinstance(cell, dict) for cell in row.cells
        ]


def setting(command: str) -> str:
    """A command without its policies, each of which plays the same episodes alone."""
    words = plain(command)
    named = {
        place + more for place, word in enumerate(words) if word == "--policy" for more in (0, 1)
    }
    return " ".join(word for place, word in enumerate(words) if place not in named)


def test_what_stands_in_two_tables_is_the_same_number() -> None:
    """Means of a policy in the episodes of a setting: one table is not older than another."""
    found: dict[tuple[str, ...], dict[str, float]] = defaultdict(dict)
    for name, piece in ALL.items():
        for row in () if name in tables.WHOLE else piece.rows:
            for cell, column in zip(row.cells, piece.columns, strict=True):
                spec = piece.spec(column, row)
                if not isinstance(cell, dict) or "mean" not in cell or "variant" in spec:
                    continue
                if spec["way"] in ("mean", "average", "beside"):
                    of = setting(piece.runs[spec["run"]]["command"])
                    world = spec.get("world", "graph")
                    found[of, spec["policy"], world, spec["key"]][name] = cell["mean"]
    shared = {of: means for of, means in found.items() if len(means) > 1}
    assert len(shared) > 20
    assert {of: m for of, m in shared.items() if max(m.values()) - min(m.values()) > 1e-9} == {}


@pytest.mark.parametrize(
    ("cell", "form", "text"),
    [
        (None, "", ""),
        ("18 of 20", ".1f", "18 of 20"),
        ({"mean": 98.546, "half": 1.52, "n": 100}, ".1f", "98.5 ± 1.5"),
        ({"n": 0}, ".2f", "–"),
        ({"mean": 74.991, "gap": -13.37, "half": 6.64, "n": 9}, ".2f", "74.99 (−13.4 ± 6.6)"),
        ({"gap": 0.0561, "half": 0.1702, "n": 100}, ".2f", "+0.06 ± 0.17"),
        ({"gap": 0.0, "half": 0.0, "n": 100}, ".2f", "0"),
        ({"gap": -0.05, "low": -0.13, "high": 0.01}, ".2f", "−0.050 (−0.130 to 0.010)"),
        ({"gap": 0.2, "low": 0.1, "high": 0.3}, ".1f", "**0.20 (0.10 to 0.30)**"),
        ({"mean": 0.9214, "low": 0.877, "high": 1.0199}, ".3g", "0.921 (0.877 to 1.02)"),
        ({"mean": 214312.0}, ".3g", "214,312"),
        ({"mean": 90.0, "low": 88.0, "high": 92.0, "n": 20}, ".1f", "90.0 ± 2.0"),
        ({"mean": 90.0, "low": 80.0, "high": 92.0, "rough": 1}, ".1f", "90.0 (80.0 to 92.0) rough"),
    ],
)
def test_cells_show_what_is_known(cell: Cell, form: str, text: str) -> None:
    assert shown(cell, Column("", form)) == text


def test_differences_are_of_pairs() -> None:
    own, other = [3.0, 5.0, float("nan")], [1.0, 2.0, 7.0]
    assert beside(own, other) == {"mean": 4.0, "gap": 2.5, "n": 2}, "too few for an interval"
    many = np.resize([1.0, 3.0], 20)
    (half,) = metrics.compared([many]).high - 2.0
    assert beside(many, np.zeros(20)) == {"mean": 2.0, "gap": 2.0, "half": half, "n": 20}
    assert interval(many, np.zeros(20)) == {"gap": 2.0, "low": 2 - half, "high": 2 + half, "n": 20}


def test_means_have_the_interval_of_their_metric() -> None:
    found = metrics.mean_interval([50.0, 60.0], 0.0, 100.0)
    told = {"mean": 55.0, "low": float(found.low), "high": float(found.high), "n": 2, "rough": 1}
    assert mean([50.0, 60.0], describe("pta_c"), 150) == told


def test_a_piece_is_made_from_its_runs_and_goes_on(tmp_path: Path) -> None:
    made = making.make(PIECE, runs=tmp_path / "runs")
    save(made, tmp_path)
    assert load("small", tmp_path) == made
    assert isinstance(made.rows[0].cells[1], dict) and made.rows[1] == PIECE.rows[1]
    assert SMALL in region(made, "") and "| of others | 98.6 |" in region(made, "")
    table = place(f"{SMALL} --jobs 2", tmp_path / "runs") / "episodes.parquet"
    written = table.stat().st_mtime_ns
    assert making.make(PIECE, runs=tmp_path / "runs").rows == made.rows
    assert table.stat().st_mtime_ns == written


def test_what_other_code_made_is_made_anew(tmp_path: Path) -> None:
    folder = playing.play(SMALL, runs=tmp_path)
    file = folder / "run.json"
    info = json.loads(file.read_text())
    file.write_text(json.dumps(info | {"code": dict.fromkeys(info["code"], "0" * 8)}))
    assert playing.play(SMALL, runs=tmp_path) == folder
    assert json.loads(file.read_text())["code"] == info["code"]
    assert len(list(tmp_path.glob(f"{folder.name}.before-*"))) == 1
