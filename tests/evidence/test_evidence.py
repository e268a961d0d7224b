"""Pages agree with the data of their evidence, and data come from runs."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.references import with_options
from mjforage.cli.commands import app
from mjforage.graph_planner.policies.registry import policy_label, policy_names
from mjforage.mission.mission_metrics import chosen_metrics
from mjforage.physics.worlds import WORLDS
from mjforage.runs.resuming import Difference, refusal
from mjforage.scenario.scenario_file import load_scenario
from tests.documents.blocks import blocks
from tests.evidence import __main__ as making
from tests.evidence import data, playing
from tests.evidence.page import PAGES, names, region, renewed, shown
from tests.evidence.piece import (
    REPOSITORY,
    Column,
    Piece,
    Row,
    average,
    beside,
    gap,
    interval,
    mean,
)
from tests.evidence.pieces import PIECES, learning, tuning, worlds
from tests.evidence.playing import Runs, place, plain

TABLES = {name: piece for name, piece in PIECES.items() if piece.columns}
SMALL = "mjforage evaluate comb-port --policy greedy --policy levy --episodes 2 --set horizon=12"


def small(runs: Runs) -> Iterator[Row]:
    for policy in ("greedy", "levy"):
        yield [policy, mean(runs.only.values(policy, "pta_c"))]


PIECE = Piece("small", {"": SMALL}, (Column("policy"), Column("PTA_C %", 1)), small)


@pytest.mark.parametrize("page", PAGES)
def test_every_region_is_what_its_data_say(page: str) -> None:
    text = (REPOSITORY / page).read_text("utf-8")
    told = names(text)
    assert sorted(told) == sorted(re.findall(r"^<!-- evidence: (.*) -->$", text, re.M))
    drawn = {name: region(TABLES[name], data.load(TABLES[name])) for name in told}
    assert renewed(page, text, drawn) == text, "python -m tests.evidence --pages draws it"


def test_every_table_stands_on_a_page() -> None:
    told = [name for page in PAGES for name in names((REPOSITORY / page).read_text("utf-8"))]
    assert sorted(set(told)) == sorted(TABLES)


def test_data_are_of_pieces() -> None:
    assert sorted(path.stem for path in data.DATA.glob("*.json")) == sorted(PIECES)


@pytest.mark.parametrize("name", PIECES)
def test_data_are_of_the_commands_of_today(name: str) -> None:
    piece = PIECES[name]
    content = data.load(piece)
    assert data.commands(content) == dict(piece.runs)
    assert all(len(row) == len(piece.columns) for row in content["rows"])
    assert bool(content["rows"]) == bool(piece.columns)


@pytest.mark.parametrize("name", PIECES)
def test_minutes_are_reckoned_only_where_no_run_tells_them(name: str) -> None:
    assert (PIECES[name].minutes > 0.0) == (data.cpu_minutes(data.load(PIECES[name])) is None)


@pytest.mark.parametrize("name", [name for name, piece in PIECES.items() if piece.files])
def test_files_that_are_written_whole_are_as_they_were_written(name: str) -> None:
    piece = PIECES[name]
    told = data.load(piece)["files"]
    assert {name: data.digest(REPOSITORY / name) for name in piece.files} == told


def test_settings_of_commands_are_of_scenarios() -> None:
    """What would be refused hours after the start is refused here."""
    settings = set()
    commands = {command for piece in PIECES.values() for command in piece.runs.values()}
    for command in commands - {one for one in commands if one.startswith("python -m tests.")}:
        _, bound, _ = app.parse_args(plain(command), exit_on_error=False, print_error=False)
        given = bound.arguments
        if "scenario" in given and "courses" not in given:
            chosen = given.get("choice")
            options = vars(chosen) if chosen else given
            _, overrides = with_options("policy", given.get("policy", ()), options.get("set", ()))
            settings.add((given["scenario"], overrides, options.get("map")))
    assert len(settings) > 20
    for scenario, overrides, where in settings:
        load_scenario(scenario, overrides, where)


def test_commands_of_regions_are_left_to_evidence() -> None:
    own = [
        block for page in PAGES for block in blocks(page) if block.mark == "run by make evidence"
    ]
    assert own and not any(block.long or block.runs for block in own)


@pytest.mark.parametrize(
    ("cell", "column", "text"),
    [
        (None, Column(""), ""),
        ("18 of 20", Column(""), "18 of 20"),
        ({"mean": 98.546, "half": 1.52, "n": 100}, Column("", 1), "98.5 ± 1.5"),
        ({"mean": 98.546, "n": 100}, Column("", 2), "98.55"),
        ({"n": 0}, Column("", 2), "–"),
        (
            {"mean": 74.991, "gap": -13.37, "half": 6.64, "n": 9},
            Column("", 2),
            "74.99 (−13.4 ± 6.6)",
        ),
        ({"gap": 0.0561, "half": 0.1702, "n": 100}, Column("", 2), "+0.06 ± 0.17"),
        ({"gap": 0.0, "half": 0.0, "n": 100}, Column("", 2), "0"),
        ({"gap": -0.05, "low": -0.13, "high": 0.01}, Column("", 2), "−0.050 (−0.130 to 0.010)"),
        ({"gap": 0.2, "low": 0.1, "high": 0.3}, Column("", 1), "**0.20 (0.10 to 0.30)**"),
        (
            {"mean": 0.9214, "low": 0.877, "high": 1.0199},
            Column("", 3, True),
            "0.921 (0.877 to 1.02)",
        ),
        ({"mean": 214312.0}, Column("", 3, True), "214,312"),
        ({"mean": 99.93, "low": 99.87, "high": 99.99}, Column("", 3, True), "99.9 (99.9 to 100)"),
    ],
)
def test_cells_show_what_is_known(cell: Row, column: Column, text: str) -> None:
    assert shown(cell, column) == text  # type: ignore[arg-type]


def test_statistics_are_of_pairs() -> None:
    own, other = [3.0, 5.0, float("nan")], [1.0, 2.0, 7.0]
    assert average(own) == {"mean": 4.0, "n": 2}
    assert mean(own) == {"mean": 4.0, "half": pytest.approx(1.96), "n": 2}
    assert gap(own, other) == {"gap": 2.5, "half": pytest.approx(0.98), "n": 2}
    assert beside(own, other) == {"mean": 4.0, "gap": 2.5, "half": pytest.approx(0.98), "n": 2}
    assert interval(own, other) == {"gap": 2.5, "low": 2.0, "high": 3.0, "n": 2}


def test_who_computes_makes_no_other_run() -> None:
    alone = "mjforage evaluate comb-port --policy greedy"
    assert plain(f"{alone} --jobs 2") == plain(alone)
    assert place(f"{alone} --jobs 2") == place(alone)
    assert place(f"{alone} --seed 1") != place(alone)


def test_a_region_is_drawn_and_words_around_it_stay() -> None:
    text = "before\n<!-- evidence: small -->\nold\n<!-- end of small -->\nafter\n"
    drawn = renewed("docs/physics.md", text, {"small": "new {data}\n"})
    assert drawn == text.replace("old", "new evidence/data/small.json")
    assert renewed("docs/physics.md", text, {}) == text


def test_a_piece_is_made_from_its_runs_and_goes_on(tmp_path: Path) -> None:
    making.make(PIECE, runs=tmp_path / "runs", folder=tmp_path)
    content = data.load(PIECE, tmp_path)
    (run,) = content["runs"].values()
    assert (run["command"], run["seed"], run["episodes"]) == (SMALL, 0, 2)
    assert len(run["hash"]) == 16 and content["made"]["versions"]["numpy"]
    told = region(PIECE, content)
    assert (
        SMALL in told and f"| greedy | {shown(content['rows'][0][1], PIECE.columns[1])} |" in told
    )
    table = place(SMALL, tmp_path / "runs") / "episodes.parquet"
    made = table.stat().st_mtime_ns
    making.make(PIECE, runs=tmp_path / "runs", folder=tmp_path)
    assert table.stat().st_mtime_ns == made
    assert data.load(PIECE, tmp_path)["rows"] == content["rows"]


def test_what_other_code_made_is_made_anew(tmp_path: Path) -> None:
    folder = playing.play(SMALL, runs=tmp_path)
    file = folder / "run.json"
    info = json.loads(file.read_text())
    changed = dict.fromkeys(info["code"], "0" * 8)
    file.write_text(json.dumps(info | {"code": changed}))
    assert playing.play(SMALL, runs=tmp_path) == folder
    assert json.loads(file.read_text())["code"] == info["code"]
    assert len(list(tmp_path.glob(f"{folder.name}.before-*"))) == 1
    assert playing.FRESH in refusal("run", [Difference("code", "the code differs")])


def test_other_refusals_are_told(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="unknown"):
        playing.play(SMALL.replace("greedy", "gredy"), runs=tmp_path)


def test_a_name_that_is_none_is_refused() -> None:
    with pytest.raises(SystemExit, match="smal unknown"):
        making.main(["smal"])


class _Promised:
    """A run that is not there: its command says what it would hold."""

    def __init__(self, command: str) -> None:
        _, bound, _ = app.parse_args(plain(command), exit_on_error=False, print_error=False)
        given = bound.arguments
        found = tuple(WORLDS) if "ladder" in given else ("graph", "physics")
        choice = vars(given["choice"]) if "choice" in given else given
        named, _ = with_options("policy", given["policy"], choice.get("set", ()))
        policies = tuple(policy_label(one) if "(" in one else one for one in named)
        self.info = SimpleNamespace(policies=policies, worlds=found)
        self._known = {one.key for one in chosen_metrics()}

    def values(self, policy: str, key: str, world: str = "graph") -> NDArray[np.float64]:
        assert policy in self.info.policies and world in self.info.worlds and key in self._known
        return np.array([1.0, 2.0, 4.0])


def _of(*commands: str) -> list[str]:
    """Tables whose runs are made by one of these commands of ours."""
    return [
        name
        for name, piece in TABLES.items()
        if next(iter(piece.runs.values())).split()[1] in commands
    ]


PLAYED = _of("evaluate", "compare")
TRAINED = _of("train")


@pytest.mark.parametrize("name", PLAYED)
def test_rows_take_what_their_commands_make(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worlds, "_fastest_touch", lambda run: 0.2)
    piece = PIECES[name]
    promised = {label: _Promised(command) for label, command in piece.runs.items()}
    runs = Runs(dict.fromkeys(piece.runs, Path()))
    runs._read = promised  # type: ignore[assignment]
    runs.__dict__["only"] = next(iter(promised.values()))
    rows = [list(row) for row in piece.rows(runs)]
    assert {len(row) for row in rows} == {len(piece.columns)}
    assert {row[0] for row in rows} == {row[0] for row in data.load(piece)["rows"]}


@pytest.mark.parametrize("name", TRAINED)
def test_rows_of_trainings_take_what_they_leave(
    name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Weights of every training play, and nothing else than what stands in a command's folder."""

    def promised(folder: Path, command: str) -> _Promised:
        run = _Promised(command)
        own = {file.stem for file in folder.glob("*.safetensors")}
        assert own <= set(run.info.policies) <= own | set(policy_names())
        return run

    for module in (learning, tuning):
        monkeypatch.setattr(module, "run_in", promised)
    folders = {}
    for label in PIECES[name].runs:
        folders[label] = tmp_path / label.replace(", ", "-").replace(" ", "-")
        folders[label].mkdir()
        for weights in ("best", "weights"):
            (folders[label] / f"{weights}.safetensors").touch()
        rows = pl.DataFrame({"updates": [0.0, 500.0, 1000.0], "rank": [3.0, 1.0, 2.0]})
        rows.write_parquet(folders[label] / "evaluations.parquet")
    played = [list(row) for row in PIECES[name].rows(Runs(folders))]
    assert {len(row) for row in played} == {len(PIECES[name].columns)}
    assert len(played) == len(data.load(PIECES[name])["rows"])


@pytest.mark.parametrize(
    ("line", "other", "told"),
    [
        ("| 99.7 |", "| 99.8 |", True),
        ("mjforage study board --seed 7", "mjforage study board --seed 8", True),
        ("100 episodes, seed 7; commit b26766dc2b4c", "100 episodes, seed 8; commit 0", True),
        ("Bold: the best mean.", "Bold: the best.", False),
    ],
)
def test_the_digest_of_a_page_is_of_what_no_hand_mends(
    line: str, other: str, told: bool, tmp_path: Path
) -> None:
    text = "Words.\n\n{}\n\n```sh\n{}\n```\n"
    digests = []
    for one in (line, other):
        command = one if one.startswith("mjforage") else "mjforage"
        (tmp_path / "page.md").write_text(text.format(one.removeprefix(command), command))
        digests.append(data.digest(tmp_path / "page.md"))
    assert (digests[0] != digests[1]) == told
