import base64
import json
import math
import re
import shutil
from collections.abc import Callable
from hashlib import sha256
from html import unescape
from pathlib import Path
from typing import Any

import polars as pl
import pytest
from rich.console import Console

from mjforage.base.errors import UserError
from mjforage.view.report import terminal_table, write_report
from tests.mjforage.view.report.made_up_episodes import Plan
from tests.mjforage.view.report.made_up_runs import build

MakeRun = Callable[..., Path]

FIGURES = (
    "scenario",
    "tracks",
    "pta",
    "idleness",
    "rmse",
    "csr",
    "gini",
    "overlap",
    "ages",
    "holders",
    "dsl",
    "itl",
    "metric-handover",
)
OF_LINKS = (
    *("position_age", "disagreement", "rmse_holders", "contact"),
    *("delivered", "lost", "dropped", "bytes_sent", "handover"),
)
SECTIONS = (
    "replay",
    "result",
    "run",
    "scene",
    "figures",
    "tables",
    "all",
    "comparison",
    "notes",
    "settings",
)


def written(folder: Path) -> str:
    return write_report(folder).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def reported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a run that nobody may change, greedy and levy, with its report."""
    folder = build(tmp_path_factory.mktemp("reported") / "run", Plan())
    write_report(folder)
    return folder


@pytest.fixture(scope="module")
def page(reported: Path) -> str:
    return (reported / "report.html").read_text(encoding="utf-8")


def test_every_section_and_figure_is_there(reported: Path, page: str) -> None:
    assert re.findall(r'<section id="([a-z]+)">', page) == list(SECTIONS)
    assert set(re.findall(r'<figure id="figure-([a-z-]+)"', page)) == set(FIGURES)
    assert page.count("data:image/") == len(FIGURES)
    files = {path.name for path in (reported / "figures").iterdir()}
    assert files == {f"{name}.{kind}" for name in FIGURES for kind in ("png", "svg")}


def test_the_page_needs_nothing_from_outside(page: str) -> None:
    references = re.findall(r'(?:src|href|url)\s*[=(]\s*"?([^")>\s]+)', page)
    assert references
    inside = ("#", "data:image/", "data:text/csv;")
    assert all(ref.startswith(inside) for ref in references)
    assert page.count("<script") == page.count("<script>") + 1  # the replay's data, and code
    assert "<link" not in page
    assert "@import" not in page


def test_the_page_forbids_everything_from_outside_and_other_scripts(page: str) -> None:
    """Its policy stands before all that it rules, and allows the page's own scripts alone."""
    head = page.split("<title>", 1)[0]
    (rules,) = re.findall(r'http-equiv="Content-Security-Policy" content="([^"]+)"', head)
    rules = unescape(rules)
    assert rules.startswith("default-src 'none'; script-src 'sha256-")
    assert not re.search(r"https?:|\*|unsafe-eval|'self'", rules)
    assert rules.count("'unsafe-inline'") == 1 and "style-src 'unsafe-inline'" in rules
    scripts = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)
    digests = [base64.b64encode(sha256(one.encode()).digest()).decode() for one in scripts]
    assert len(scripts) == 2
    assert sorted(re.findall(r"'sha256-([^']+)'", rules)) == sorted(digests)


def test_the_same_logs_give_the_same_bytes(reported: Path, tmp_path: Path) -> None:
    first = (reported / "report.html").read_bytes()
    images = {path.name: path.read_bytes() for path in (reported / "figures").iterdir()}
    folder = Path(shutil.copytree(reported, tmp_path / "run"))
    (folder / "report.html").unlink()
    shutil.rmtree(folder / "figures")
    assert write_report(folder).read_bytes() == first
    assert {path.name: path.read_bytes() for path in (folder / "figures").iterdir()} == images


@pytest.mark.usefixtures("unprinted")
def test_a_hostile_name_is_escaped(make_run: MakeRun) -> None:
    name = "<script>alert(1)</script>\"'&{{ 7*7 }}`x`"
    policy = "<img src=x onerror=alert(2)>"
    page = written(make_run(name=name, policies=("greedy", policy), replays=("greedy",)))
    assert "<script>alert" not in page
    assert "<img src=x" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page
    assert "49" not in page.split("<h1>", 1)[1].split("</h1>", 1)[0]


@pytest.mark.parametrize(
    ("settings", "phrase"),
    [
        ({"scouts": 0}, "2 policies, 3 episodes each"),
        ({"foragers": 0}, "2 policies, 3 episodes each"),
        ({"scouts": 0, "foragers": 0}, "no vessels"),
        ({"episodes": 1, "policies": ("greedy",), "shape": (9, 30)}, "1 policy, 1 episode each"),
        ({"worlds": ("graph", "physics"), "episodes": 2}, "levy · physics"),
    ],
)
def test_unusual_runs(make_run: MakeRun, settings: dict[str, Any], phrase: str) -> None:
    page = written(make_run(**settings))
    words = re.sub(r"data:image/[^\"]+", "", page)
    assert phrase in " ".join(words.split())
    assert not re.search(r"\b(nan|None|inf)\b", words.split("<main>", 1)[1].split("<pre>{", 1)[0])


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def foreign(path: Path) -> None:
    pl.DataFrame({"a": [1]}).write_parquet(path)


def drop_rows(path: Path) -> None:
    pl.read_parquet(path).head(-1).write_parquet(path)


def inflate(path: Path) -> None:
    """Rows that pack into next to nothing."""
    pl.concat([pl.read_parquet(path).head(1)] * 500_000).write_parquet(path)


def text(path: Path) -> None:
    path.write_text("not what it says")


@pytest.mark.parametrize(
    ("name", "damage", "words"),
    [
        ("run.json", Path.unlink, "missing"),
        ("run.json", cut, "cannot be read as JSON"),
        ("run.json", lambda path: path.write_text("[1]"), "holds a list"),
        ("run.json", lambda path: path.write_text("[" * 100_000), "cannot be read as JSON"),
        ("run.json", lambda path: path.write_text("{}"), "missing command, scenario, map"),
        ("summary.json", Path.unlink, "missing"),
        ("summary.json", lambda path: path.write_text('{"graph": {}}'), "graph/greedy is missing"),
        ("summary.json", lambda path: path.write_text('{"graph": 3}'), "malformed"),
        ("episodes.parquet", Path.unlink, "missing"),
        ("episodes.parquet", cut, "truncated or not Parquet"),
        ("episodes.parquet", text, "truncated or not Parquet"),
        ("episodes.parquet", foreign, "column 'world' is missing"),
        ("episodes.parquet", drop_rows, "has 2 rows, expected 3"),
        ("steps.parquet", cut, "truncated or not Parquet"),
        ("steps.parquet", drop_rows, "has 38 rows, expected 39"),
        ("items.parquet", foreign, "column 'world' is missing"),
        ("items.parquet", inflate, "has 500,000 rows, at most 240,000 are of this run"),
        ("agents.parquet", inflate, "has 500,000 rows, at most "),
        ("agents.parquet", cut, "truncated or not Parquet"),
        ("replay/graph-greedy-0.npz", cut, "greedy-0.npz"),
    ],
)
def test_damage_is_named(
    make_run: MakeRun, name: str, damage: Callable[[Path], object], words: str
) -> None:
    folder = make_run()
    damage(folder / name)
    with pytest.raises(UserError, match=re.escape(words)) as caught:
        write_report(folder)
    assert Path(name).name in str(caught.value)
    assert "run what made this folder again" in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not (folder / "report.html").exists()


def test_logs_of_another_run_are_refused(make_run: MakeRun) -> None:
    folder, other = make_run(), make_run(policies=("greedy", "pso"))
    shutil.copy(other / "episodes.parquet", folder / "episodes.parquet")
    with pytest.raises(UserError, match=r"holds graph/pso, which run\.json"):
        write_report(folder)


def test_missing_folder_and_blocked_target(make_run: MakeRun, tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no such folder"):
        write_report(tmp_path / "nowhere")
    folder = make_run()
    (folder / "figures").write_text("a file where the folder should be")
    with pytest.raises(UserError, match="cannot be written"):
        write_report(folder)


@pytest.mark.usefixtures("unprinted")
def test_metrics_of_a_link_are_left_out_where_there_is_none(make_run: MakeRun) -> None:
    """As evaluate writes them then: no number anywhere."""
    folder = make_run()
    for name in ("episodes", "steps"):
        path = folder / f"{name}.parquet"
        frame = pl.read_parquet(path)
        undefined = [key for key in OF_LINKS if key in frame.columns]
        nan = [pl.lit(math.nan).cast(frame.schema[key]).alias(key) for key in undefined]
        frame.with_columns(nan).write_parquet(path)
    summary = json.loads((folder / "summary.json").read_text())
    nothing = {"mean": None, "sem": None, "ci95": [None, None], "iqm": None, "n": 0}
    for entries in summary["graph"].values():
        entries |= dict.fromkeys(OF_LINKS, nothing)
    (folder / "summary.json").write_text(json.dumps(summary))
    page = written(folder)
    figures = set(re.findall(r'<figure id="figure-([a-z-]+)"', page))
    assert figures == set(FIGURES) - {"holders", "metric-handover"}, "maps still have an age"
    assert "Handover" not in page.split('id="table-paired"', 1)[1].split("</table>", 1)[0]
    assert "Undefined in every episode: " in page and ">PA<" not in page


def test_terminal_table(make_run: MakeRun) -> None:
    folder = make_run(foragers=0)
    summary = json.loads((folder / "summary.json").read_text())
    console = Console(width=100, record=True, quiet=False, file=(folder / "out.txt").open("w"))
    with console.file:
        console.print(terminal_table(summary))
    shown = console.export_text()
    assert f"{summary['graph']['greedy']['pta_d']['mean']:.2f}" in shown
    assert "CSR" not in shown, "columns without a number are left out"
    assert "greedy" in shown
    assert "…" not in shown
