import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import polars as pl
import pytest
from PIL import Image
from rich.console import Console

from graph_planner.policies import policy_names
from mjforage import __version__
from mjforage.cli import console
from mjforage.core.maps import load_map
from mjforage.core.mission_metrics import chosen_metrics
from mjforage.core.scenario_file import preset_names
from mjforage.view.report import terminal_table

Refused = Callable[..., str]
GREEDY = ("evaluate", "comb-port", "--policy", "greedy")
EVALUATE = (*GREEDY, "--episodes", 2, "--set", "horizon=8")
PROGRAM = "from mjforage.cli import main; main()"


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in an empty folder, so that a command that should be refused can be seen to write."""
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    width = console.PIPE_COLUMNS  # the test runner sets COLUMNS
    monkeypatch.setattr(console.output, "width", width)
    return folder


@pytest.fixture(scope="module")
def reported(tmp_path_factory: pytest.TempPathFactory) -> "tuple[Path, list[str]]":
    """Return a run with its report, made by a process of its own, and the lines that it printed."""
    folder = tmp_path_factory.mktemp("reported") / "run"
    arguments = [*map(str, EVALUATE), "--policy", "lawnmower", "--out", str(folder)]
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *arguments],
        capture_output=True,
        text=True,
        check=True,
        env={key: value for key, value in os.environ.items() if key != "COLUMNS"},
    )
    slow = r"[^\n]* (so far|left)\n"  # on a busy machine
    assert re.fullmatch(f"({slow})*", done.stderr)
    return folder, done.stdout.splitlines()


@pytest.fixture
def folder(reported: tuple[Path, list[str]], tmp_path: Path) -> Path:
    """Return a run with its report, to spoil."""
    return Path(shutil.copytree(reported[0], tmp_path / "run"))


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
    for word in ("PTA D", "NT 50", "Throughput", "CSR", "Length", "[steps]", "lawnmower", "± "):
        assert word in table
    mean = json.loads((folder / "summary.json").read_text())["graph"]["greedy"]["pta_d"]["mean"]
    assert f"{mean:.2f}" in table


def test_the_table_fits_a_terminal_of_80_columns() -> None:
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
    console = Console(width=80, file=sys.stdout)
    with console.capture() as captured:
        console.print(terminal_table(summary))
    assert "…" not in captured.get()
    with console.capture() as captured:
        console.print(terminal_table(summary), width=60)
    assert "…" in captured.get()


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


def test_a_report_that_cannot_be_written_is_one_line(refused: Refused, folder: Path) -> None:
    (folder / "report.html").unlink()
    (folder / "report.html").mkdir()
    message = refused(*EVALUATE, "--policy", "lawnmower", "--out", folder)
    assert message.startswith(f"mjforage: {folder / 'report.html'}: cannot be written")
    assert (folder / "summary.json").is_file()


@pytest.mark.parametrize("table", ["episodes", "steps", "items", "agents"])
@pytest.mark.parametrize("content", [b"", b"PAR1 truncated", None])
def test_a_spoilt_table_is_one_line_and_stays(
    table: str, content: bytes | None, refused: Refused, folder: Path
) -> None:
    path = folder / f"{table}.parquet"
    if content is None:
        pl.DataFrame({"price": [1.0]}).write_parquet(path)
    else:
        path.write_bytes(content)
    before = path.read_bytes()
    assert str(path) in refused(*EVALUATE, "--policy", "lawnmower", "--out", folder)
    assert str(path) in refused("report", folder)
    assert path.read_bytes() == before


def test_a_spoilt_table_moved_away_is_made_again(
    command: Callable[..., Any], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mjforage.view.report.write_report", lambda folder: folder / "report.html")
    path = folder / "steps.parquet"
    whole, summary = path.read_bytes(), (folder / "summary.json").read_bytes()
    path.unlink()
    assert command(*EVALUATE, "--policy", "lawnmower", "--out", folder).code == 0
    assert path.read_bytes() == whole
    assert (folder / "summary.json").read_bytes() == summary


def test_another_run_in_the_folder_is_one_line(refused: Refused, folder: Path) -> None:
    message = refused(*EVALUATE, "--policy", "lawnmower", "--seed", 3, "--out", folder)
    assert (
        f"{folder}: holds another run: seed is 0 there and 3 here; give --fresh to keep that "
        "folder aside and begin anew, or choose another --out" in message
    )


def test_the_default_folder_has_the_name_of_the_scenario(
    command: Callable[..., Any], here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mjforage.view.report.write_report", lambda folder: folder / "report.html")
    assert command(*EVALUATE, "--set", "name=[bold]x").code == 0
    assert (here / "runs" / "[bold]x" / "summary.json").is_file()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["evalute"], 'Unknown command "evalute". Did you mean "evaluate"?'),
        (["--nonsense"], "--nonsense"),
        (["evaluate", "--polcy", "greedy"], "--polcy. Did you mean --policy?"),
        (["evaluate"], "--policy requires an argument"),
        (["evaluate", "--policy"], "--policy"),
        (["evaluate", "--policy", "gredy"], "policy gredy: unknown; did you mean greedy?"),
        (["evaluate", "--policy", "greedy", "--policy", "greedy"], "policy greedy: given twice"),
        (
            [*EVALUATE, "--world", "moon"],
            "world moon: unknown; choose graph, hulls, calibrated, debris",
        ),
        ([*GREEDY, "--episodes", "0"], "episodes 0, seed 0: give at least 1"),
        ([*GREEDY, "--episodes", "many"], '--episodes: unable to convert "many" into int'),
        ([*EVALUATE, "--jobs", "0"], "jobs 0"),
        ([*EVALUATE, "--seed", "-1"], "seed -1"),
        ([*EVALUATE, "--map", "comb_prot"], "did you mean comb_port?"),
        ([*EVALUATE, "--map", "open_bay"], "is on land in map open_bay; give --set map.starts="),
        ([*EVALUATE, "--set", "team.scouts.count=-1"], "team.scouts.count = -1 is out of range"),
        ([*EVALUATE, "--set", "team.scuots.count=1"], "missing team.scuots.moves"),
        ([*EVALUATE, "--set", "horizon"], "--set horizon: expected KEY=VALUE"),
        ([*EVALUATE, "--out", "/proc/nowhere/run"], "/proc/nowhere/run: cannot be written"),
        (["evaluate", "comb-prot", "--policy", "greedy"], "did you mean comb-port?"),
        (["report", "nowhere"], "nowhere: no such folder"),
        (["report"], "FOLDER"),
        (["render", "nowhere", "-o", "a.png"], "nowhere/run.json: file is missing"),
        (["render", "nowhere"], "--output"),
        (["maps", "nowhere"], "map 'nowhere': no such file or shipped map"),
        (["maps", "harbour:comb:7"], "no kind 'comb'; give harbour:KIND:SEED or harbour:KIND:SEED"),
        (["maps", "harbours:0-2", "-o", "a.csv"], "picture a.csv: unknown kind; give"),
        ([*EVALUATE, "--map", "harbours:0-2"], "give one, such as harbour:combs:0"),
        (["train", "ddqn", "--updates", "1", "--also", "comb-port:harbours:2-0"], "FIRST-LAST"),
        (["maps", "comb_port", "-o", "nowhere/a.png"], "nowhere/a.png: cannot be written"),
        (["bench", "--jsn", "a"], "--jsn. Did you mean --json?"),
    ],
)
def test_what_a_user_can_mend_is_one_line(
    arguments: list[object], words: str, refused: Refused, here: Path
) -> None:
    assert words in refused(*arguments)
    assert list(here.iterdir()) == []


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("1,1\n1\n1,1\n", "map port.csv: row 1 has 1 columns, expected 2"),
        ("", "map port.csv: is empty"),
        ("0,0\n0,0\n", "map port.csv: all 4 cells are obstacles"),
        (
            "1,0,1\n1,0,1\n",
            "form 2 separate components, the largest of 2 nodes; keep only that one "
            "with --set map.largest_component=true",
        ),
        ("1,0\n0,1\n", "or join them with --set map.corner_cutting=true"),
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
    monkeypatch.setattr("mjforage.view.report.write_report", lambda folder: folder / "report.html")
    Path("port.csv").write_text("1,1,1,0,1\n1,1,1,0,1\n")
    arguments = (
        *("evaluate", "channels", "--policy", "greedy", "--map", "port.csv", "--episodes", 1),
        *("--set", "map.largest_component=true", "--set", "horizon=3"),
    )
    outcome = command(*arguments)
    assert outcome.code == 0
    assert "6 nodes" in outcome.out
    assert "2 of 8 nodes lie outside the largest of 2 components" in caplog.text


def test_an_error_of_the_system_is_one_line(
    refused: Refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device", "cache.nbi")

    monkeypatch.setattr("mjforage.view.report.write_report", fail)
    assert "cache.nbi: No space left on device; free some space" in refused("report", ".")


def test_a_fault_of_ours_is_not_hidden(
    command: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("mjforage.view.report.write_report", fail)
    with pytest.raises(ZeroDivisionError):
        command("report", ".")


def test_lists_name_everything_in_one_line_each(command: Callable[..., Any]) -> None:
    for name, names in (("policies", policy_names()), ("scenarios", preset_names())):
        lines = command(name).out.splitlines()
        assert [line.split()[0] for line in lines] == names
        assert all(len(line.split()) > 3 for line in lines)
    assert "comb_port: 62 x 46, 1297 nodes" in command("maps").out.splitlines()


def test_one_map_is_checked_and_drawn(command: Callable[..., Any]) -> None:
    Path("port.csv").write_text("1,1\n1,0\n")
    outcome = command("maps", "port.csv", "-o", "port.png")
    assert (outcome.code, outcome.out) == (0, "port.csv: 2 x 2, 3 nodes\n")
    with Image.open("port.png") as image:
        assert image.width > 100


def test_generated_harbours_are_drawn_and_written(command: Callable[..., Any]) -> None:
    outcome = command("maps", "harbour:combs:7:30x44", "-o", "port.csv")
    assert outcome.code == 0
    again = command("maps", "port.csv")
    assert outcome.out.split(": ")[1] == again.out.split(": ")[1]
    assert (load_map("port.csv").navigable == load_map("harbour:combs:7:30x44").navigable).all()
    assert len(command("maps", "harbours:0-6", "-o", "sheet.png").out.splitlines()) == 7
    with Image.open("sheet.png") as image:
        assert image.width > 400


def test_a_generated_harbour_is_a_map_like_any(
    command: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Starts of the scenario's own map do not hold there: they are drawn."""
    monkeypatch.setattr("mjforage.view.report.write_report", lambda folder: folder / "report.html")
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


def test_version_and_help(command: Callable[..., Any]) -> None:
    assert command("--version").out.strip() == __version__
    text = command("--help").out
    for name in ("bench", "compare", "evaluate", "maps", "policies", "render", "validate", "view"):
        assert name in text
        assert "Usage" in command(name, "--help").out
    assert command().out == text


def test_render_draws_a_frame_a_series_and_films(
    command: Callable[..., Any], folder: Path, here: Path
) -> None:
    short = ("--duration", 20, "--fps", 4, "--width", 320)
    for arguments in (
        ("-o", "frame.png", "--episode", 1, "--start", 40),
        ("-o", "film.gif", "--policy", "lawnmower", *short),
        ("--output", "film.mp4", *short),
        ("-o", "beside.mp4", "--beside", "lawnmower", *short, "--height", 241),
        ("-o", "frame-%02d.png", *short),
    ):
        outcome = command("render", folder, *arguments)
        assert (outcome.code, outcome.err) == (0, "")
        assert outcome.out == f"film: {arguments[1]}\n"
    with Image.open("frame.png") as image:
        assert len(image.convert("RGB").getcolors(1 << 24) or ()) > 20
    with Image.open("film.gif") as film:
        assert getattr(film, "n_frames", 1) > 1
    assert b"ftyp" in Path("film.mp4").read_bytes()[:12]
    assert len(list(here.glob("frame-*.png"))) > 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["-o", "a.png", "--episode", 2], "it holds episodes 0 to 1 of greedy, lawnmower"),
        (["-o", "a.png", "--policy", "pso"], "no episode 0 of pso"),
        (["-o", "a.png", "--beside", "pso"], "beside pso: not in"),
        (["-o", "a.png", "--beside", "greedy"], "beside greedy: is the film's own policy"),
        (["-o", "a.png", "--camera", "front"], 'Invalid value "front" for --camera'),
        (["-o", "a.png", "--world", "moon"], "no episode 0 of greedy in world moon"),
        (["-o", "a.doc"], "a.doc: unknown kind of file"),
        (["-o", "nowhere/a.png"], "folder nowhere does not exist"),
        (["-o", "a.png", "--start", 81], "start 81 s: the episode lasts from 0 to 80 s"),
        (["-o", "a.mp4", "--fps", 0], "fps 0: must be over 0"),
        (["-o", "a.mp4", "--speed", "-1"], "speed -1: must be over 0"),
        (["-o", "a.mp4", "--duration", "nan"], "duration nan"),
    ],
)
def test_a_film_that_cannot_be_made_is_one_line(
    arguments: list[object],
    words: str,
    refused: Refused,
    here: Path,
    reported: tuple[Path, list[str]],
) -> None:
    assert words in refused("render", reported[0], *arguments)
    assert list(here.iterdir()) == []


def test_render_refuses_a_tampered_log(refused: Refused, folder: Path) -> None:
    path = folder / "agents.parquet"
    pl.read_parquet(path).with_columns(pl.col("x_m") + 1).write_parquet(path)
    assert "does not come out as logged" in refused("render", folder, "-o", "a.png")
    assert not Path("a.png").exists()


def test_bench_writes_its_figures(
    command: Callable[..., Any], refused: Refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    figures = {"steps": {"value": 1234.6, "unit": "steps per s"}}
    monkeypatch.setattr("mjforage.bench.running.bench", lambda progress: figures)
    assert "1,235" in command("bench", "--json", "figures.json").out
    assert json.loads(Path("figures.json").read_text()) == figures
    assert "cannot be written" in refused("bench", "--json", "nowhere/figures.json")
