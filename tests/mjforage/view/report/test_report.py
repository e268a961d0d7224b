import base64
import itertools
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
from mjforage.mission.mission_metrics import chosen_metrics
from mjforage.view.page import style
from mjforage.view.report import published, terminal_table, write_report
from mjforage.view.report.cells import number
from mjforage.view.report.run_logs import load_logs, policy_name
from mjforage.view.report.text_tables import paper_tables
from tests.mjforage.printing import unprinted_figures
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


@pytest.fixture(scope="module")
def beside_the_paper(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a run like the paper's that nobody may change, with its report."""
    folder = build(tmp_path_factory.mktemp("published") / "run", Plan(name="published"))
    with unprinted_figures(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(published, "comparable", lambda run: True)
        write_report(folder)
    return folder


def table_rows(page: str, name: str) -> dict[str, list[str]]:
    """Cells of a table by row head, without markup."""
    anchor = "table-" + name.removeprefix("table-")
    block = page.split(f'id="{anchor}"', 1)[1].split("</table>", 1)[0]
    rows = re.findall(r'<th scope="row">(.*?)</th>(.*?)</tr>', block)
    plain = {
        unescape(re.sub(r"<[^>]+>", "", head)): [
            unescape(re.sub(r"<[^>]+>", "", cell))
            for cell in re.findall(r"<td[^>]*>(.*?)</td>", cells)
        ]
        for head, cells in rows
    }
    assert plain
    return plain


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


def test_labels_cannot_break_a_figure(make_run: MakeRun) -> None:
    name = r"$\frac{$"
    page = written(make_run(name=name, policies=("greedy", name), replays=("greedy",)))
    assert name in page


def test_table_2_shows_the_summary_and_the_paper_beside_it(beside_the_paper: Path) -> None:
    rows = table_rows((beside_the_paper / "report.html").read_text(encoding="utf-8"), "table-2")
    summary = json.loads((beside_the_paper / "summary.json").read_text())["graph"]["greedy"]
    entries = [(summary["pta_d"], 2), (summary["pta_c"], 2), (summary["rmse"], 4)]
    expected = [f"{e['mean']:.{d}f} ± {1.96 * e['sem']:.{d}f}" for e, d in entries]
    assert rows["greedy"][:3] == expected
    assert rows["Greedy, paper (its own map)"] == [
        "98.85 ± 1.04",
        "98.20 ± 1.15",
        "–",
        "0.0017 ± 0.0012",
    ]
    code = "its public code (its own map), 1,300 episodes"
    pooled = ["98.56 ± 0.40", "97.20 ± 0.51", "0.0069 ± 0.0014", "0.0018"]
    assert rows[f"Greedy, {code}"] == pooled
    straight = "Lévy walks, walked straight"
    assert rows[f"{straight}, paper (its own map)"][0] == "82.28 ± 5.93"
    kept = "Lévy walks, its public code with lengths kept (its own map), 600 episodes"
    assert rows[kept] == ["82.50 ± 2.40", "80.00 ± 2.50", "–", "0.0159"]


def test_the_straight_walk_has_the_papers_levy_rows_and_a_note_says_so(
    make_run: MakeRun, beside_the_paper: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(published, "comparable", lambda run: True)
    assert "never uses them" in (beside_the_paper / "report.html").read_text(encoding="utf-8")
    for policy, said in (("greedy", False), ("levy", True), ("wanderer", True)):
        tables = paper_tables(load_logs(make_run(policies=(policy,))))
        notes = " ".join(note for table in tables for note in table.notes)
        assert ("never uses them" in notes) is said
    rows = {row.head: list(row.cells) for row in tables[0].rows}
    straight = "Lévy walks, walked straight"
    assert rows[f"{straight}, paper (its own map)"][1] == "80.43 ± 5.98"
    code = f"{straight}, its public code (its own map), 1,300 episodes"
    assert rows[code] == ["82.02 ± 1.67", "79.08 ± 1.73", "0.0522", "0.0168"]


def test_tables_3_and_4_show_means_with_their_intervals(beside_the_paper: Path) -> None:
    page = (beside_the_paper / "report.html").read_text(encoding="utf-8")
    summary = json.loads((beside_the_paper / "summary.json").read_text())["graph"]["levy"]
    shown = {
        key: f"{summary[key]['mean']:.3f} ± {1.96 * summary[key]['sem']:.3f}"
        for key in ("nt50", "nt90", "throughput", "csr")
    }
    cells = list(shown.values())[:3]
    for place, key in enumerate(("nt50", "nt90")):
        cells[place] += f" {2 * summary[key]['mean']:.1f} min"  # the horizon is two minutes
    assert table_rows(page, "table-3")["levy"] == cells
    assert table_rows(page, "table-4")["levy"] == [shown["csr"]]
    assert table_rows(page, "table-4")["Greedy, paper (its own map)"] == ["0.899"]


def test_another_scenario_is_not_set_beside_the_paper(make_run: MakeRun) -> None:
    logs = load_logs(make_run(name="open-bay"))
    heads = [row.head for table in paper_tables(logs) for row in table.rows]
    assert "its own map" not in " ".join(heads)


def test_every_metric_is_in_the_full_table(reported: Path, page: str) -> None:
    block = page.split('id="table-metrics"', 1)[1].split("</table>", 1)[0]
    values = json.loads((reported / "summary.json").read_text())["graph"]
    rows = re.findall(r'<th scope="row">.*?</th>(.*?)</tr>', block)
    shown = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in rows]
    expected = []
    for metric, policy in itertools.product(chosen_metrics(), ("greedy", "levy")):
        key, digits = metric.key, metric.digits
        entry = values[policy][key]
        if entry["n"] < 2:
            pytest.fail(f"{key} is meant to be defined twice here")
        low, high = (number(end, digits) for end in entry["ci95"])
        mean, iqm = number(entry["mean"], digits), number(entry["iqm"], digits)
        half = number(1.96 * entry["sem"], digits)
        expected.append([mean, half, f"{low} to {high}", iqm, str(entry["n"])])
    assert shown == expected


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


def test_undefined_values_are_left_out_and_counted(make_run: MakeRun) -> None:
    folder = make_run(episodes=2)
    logs = load_logs(folder)
    entry = json.loads((folder / "summary.json").read_text())["graph"]["levy"]["csr"]
    assert (entry["n"], entry["sem"]) == (1, None)
    (row,) = [row for row in paper_tables(logs)[2].rows if row.head == "levy"]
    assert row.cells == (f"{entry['mean']:.3f}",)


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


def test_ten_policies(make_run: MakeRun) -> None:
    shipped = [*list(style.POLICY_COLOURS)[:8], "oracle"]
    page = written(make_run(policies=("mine", *reversed(shipped)), episodes=2))
    heads = [policy_name(name, ["oracle"]) for name in (*shipped, "mine")]
    assert list(table_rows(page, "headline")) == heads and "oracle (bound)" in heads


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
    assert "evaluate" in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not (folder / "report.html").exists()


@pytest.mark.usefixtures("unprinted")
def test_a_run_that_keeps_no_replay_has_a_page_without_it(make_run: MakeRun) -> None:
    folder = make_run()
    shutil.rmtree(folder / "replay")
    page = written(folder)
    assert 'id="replay"' not in page and 'id="figure-scenario"' not in page
    assert 'id="figure-tracks"' in page


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
