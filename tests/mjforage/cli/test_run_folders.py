"""Runs and their reports, begun again, spoilt, or of another command."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mjforage.cli import console
from mjforage.graph_planner.policies import policy_names
from mjforage.mission.scoring import chosen_metrics
from mjforage.view.report import terminal_table
from tests.mjforage.cli.short_runs import EVALUATE, Refused

pytestmark = pytest.mark.usefixtures("here")


def test_a_pipe_gets_the_whole_table(reported: tuple[Path, list[str]]) -> None:
    folder, lines = reported
    assert lines[0] == (
        "comb-port on map comb_port (62 x 46, 1297 nodes; scouts reach 100%, foragers reach 100% "
        "of them)"
    )
    assert lines[-1] == f"report: {folder / 'report.html'}"
    table = "\n".join(lines[1:-1])
    assert "…" not in table
    assert "\x1b" not in table
    for word in ("PTA D", "Below 90", "RMSE", "NT 90", "CSR", "[%]", "lawnmower", "rough"):
        assert word in table
    mean = json.loads((folder / "summary.json").read_text())["graph"]["greedy"]["pta_d"]["mean"]
    assert f"{mean:.2f}" in table


@pytest.mark.parametrize("width", [10, 30, 60, 79, 80, 200])
def test_the_figures_are_whole_on_a_terminal_of_any_width(
    width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    widest = dict.fromkeys((one.key for one in chosen_metrics()), 1.0) | {
        "pta_d": 100.0,
        "pta_c": 100.0,
        "length": 150.0,
    }
    entries = {
        key: {"mean": mean, "sem": 0.2 * mean, "ci95": [0.0, mean], "iqm": mean, "n": 100}
        for key, mean in widest.items()
    }
    summary = {"graph": dict.fromkeys(policy_names(), entries)}
    monkeypatch.setattr(console.output, "width", width)
    knowing = dict.fromkeys(("belief", "dec-mcts"), "their law")
    console.print_table(terminal_table(summary, ["oracle"], knowing))
    told = capsys.readouterr().out
    assert "…" not in told
    assert width < 30 or (told.count("(their law)"), told.count("(bound)")) == (2, 1)
    assert told.count("100.00") == 2 * len(policy_names())
    assert told.count("PTA D") == (1 if width >= 79 else len(policy_names()))
    assert max(map(len, told.splitlines())) <= width


def test_the_same_command_again_says_the_same(
    command: Callable[..., Any], reported: tuple[Path, list[str]], folder: Path
) -> None:
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    outcome = command(*EVALUATE, "--policy", "lawnmower", "--out", folder)
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.splitlines()[2:-1] == reported[1][2:-1]
    assert {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()} == before


def test_report_from_logs_alone_has_the_same_bytes(
    command: Callable[..., Any], folder: Path
) -> None:
    html, figures = folder / "report.html", folder / "figures"
    before = html.read_bytes()
    html.unlink()
    shutil.rmtree(figures)
    outcome = command("report", folder)
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out == f"report: {html}\n"
    assert html.read_bytes() == before
    assert any(figures.glob("*.png"))


@pytest.mark.usefixtures("unprinted")
def test_a_report_that_cannot_be_written_is_one_line(refused: Refused, folder: Path) -> None:
    (folder / "report.html").unlink()
    (folder / "report.html").mkdir()
    message = refused(*EVALUATE, "--policy", "lawnmower", "--out", folder)
    assert message.startswith(f"mjforage: {folder / 'report.html'}: cannot be written")
    assert (folder / "summary.json").is_file()


def test_a_spoilt_table_moved_away_is_made_again(
    command: Callable[..., Any], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "mjforage.view.report.write_report", lambda folder, *_: folder / "report.html"
    )
    path = folder / "steps.parquet"
    whole, summary = path.read_bytes(), (folder / "summary.json").read_bytes()
    path.unlink()
    assert command(*EVALUATE, "--policy", "lawnmower", "--out", folder).code == 0
    assert path.read_bytes() == whole
    assert (folder / "summary.json").read_bytes() == summary


def test_the_default_folder_has_the_name_of_the_scenario(
    command: Callable[..., Any], here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "mjforage.view.report.write_report", lambda folder, *_: folder / "report.html"
    )
    assert command(*EVALUATE, "--set", "name=[bold]x").code == 0
    assert (here / "runs" / "[bold]x" / "summary.json").is_file()


def test_an_error_of_the_system_is_one_line(
    refused: Refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device", "cache.nbi")

    monkeypatch.setattr("mjforage.api.pictures.load_run", fail)
    assert "cache.nbi: No space left on device; free some space" in refused("report", ".")


def test_a_fault_of_ours_is_not_hidden(
    command: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("mjforage.api.pictures.load_run", fail)
    with pytest.raises(ZeroDivisionError):
        command("report", ".")
