"""Metrics of a user's own folder: taken, shown, carried to other processes, part of the run."""

import importlib
import json
import math
import shutil
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

from mjforage.base.errors import UserError
from mjforage.mission.scoring import METRICS, chosen_metrics, describe
from mjforage.mission.scoring.known import checked
from mjforage.mission.scoring.metric import Metric
from mjforage.mission.setup import Setup
from mjforage.runs.evaluate import evaluate
from mjforage.runs.fingerprint import outside_code
from mjforage.runs.storage import RunFolder
from mjforage.runs.studies import variants
from mjforage.runs.studies.study import Study, run_study
from mjforage.runs.workers import Workers
from mjforage.scenario.scenario_file import load_scenario
from mjforage.view.report.cells import number

SOURCE = '''from mjforage.mission.scoring import Batch, Metric


class Waste(Metric):
    """Items that are left at the end. They drift on."""

    key, label, unit, better, digits, top = "left", "Left_T", "item", -1, 1, 0

    def series(self, batch):
        removed = batch.events.collected_at
        steps = range(batch.horizon + 1)
        import numpy as np
        gone = np.stack([((removed >= 0) & (removed <= t)).sum(axis=1) for t in steps], axis=1)
        return batch.log.n_items[:, None] - gone
'''
OWN = "own_waste:Waste"


def forget() -> None:
    for name in [name for name in sys.modules if name.startswith("own_")]:
        del sys.modules[name]
    outside_code.cache_clear()


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    (tmp_path / "own_waste.py").write_text(SOURCE)
    monkeypatch.chdir(tmp_path)
    path = list(sys.path)
    yield tmp_path
    sys.path[:] = path
    forget()


@pytest.fixture
def installed(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A package with a metric, as pip leaves it, and nothing of it in the present folder."""
    facts = folder / "site" / "own_waste-1.2.dist-info"
    facts.mkdir(parents=True)
    (facts / "METADATA").write_text("Metadata-Version: 2.1\nName: own-waste\nVersion: 1.2\n")
    (facts / "entry_points.txt").write_text("[mjforage.metrics]\nleft = own_waste:Waste\n")
    (folder / "own_waste.py").rename(folder / "site" / "own_waste.py")
    monkeypatch.syspath_prepend(folder / "site")
    METRICS.__dict__.pop("_entries", None)
    yield facts
    METRICS.__dict__.pop("_entries", None)


def uninstall(facts: Path) -> None:
    shutil.rmtree(facts.parent)
    importlib.invalidate_caches()
    METRICS.__dict__.pop("_entries", None)
    forget()


def setup() -> Setup:
    return Setup.of(load_scenario("comb-port", ["horizon=6"]))


def played(name: str, *metrics: str, jobs: int = 1, **options: Any) -> Path:
    workers = options.pop("workers", Workers(jobs))
    more: dict[str, Any] = {"episodes": 2, "metrics": metrics} | options
    evaluate(setup(), ["greedy"], Path(name), workers=workers, **more)
    return Path(name)


@pytest.mark.parametrize("remote", [False, True])
def test_other_processes_take_it_to_the_same_bits(
    folder: Path, remote: bool, request: pytest.FixtureRequest
) -> None:
    address = request.getfixturevalue("scheduler") if remote else ""
    workers = Workers(1 if remote else 2, address)
    one = played("one", OWN, episodes=30)
    two = played("two", OWN, episodes=30, workers=workers)
    for name in ("episodes", "steps"):
        assert RunFolder(one).table(name).equals(RunFolder(two).table(name))
    left = RunFolder(two).table("episodes").select("left", "items", "pta_c")
    gone = pl.col("items") - pl.col("pta_c") / 100 * pl.col("items")
    assert left.select(((pl.col("left") - gone).abs() < 1e-6).all()).item()
    assert not METRICS.has("left") and "left" not in {one.key for one in chosen_metrics()}


@pytest.mark.usefixtures("unprinted")
def test_commands_take_it_and_the_report_shows_it(
    folder: Path, command: Callable[..., Any], refused: Callable[..., str]
) -> None:
    base = ("--policy", "greedy", "--episodes", 2, "--set", "horizon=6", "--metric", OWN)
    assert command("evaluate", "comb-port", *base, "--out", "run").code == 0
    summary = json.loads((folder / "run" / "summary.json").read_text())
    assert summary["graph"]["greedy"]["left"]["n"] == 2
    (told,) = [
        m
        for m in json.loads((folder / "run" / "run.json").read_text())["metrics"]
        if m["key"] == "left"
    ]
    assert (told["unit"], told["better"]) == ("item", -1)
    page = (folder / "run" / "report.html").read_text()
    assert "Items that are left at the end" in page and "Left<sub>T</sub>" in page
    forget()
    (folder / "own_waste.py").rename(folder / "gone.txt")
    assert command("report", "run").code == 0  # by what the run says of it
    assert "Items that are left at the end" in (folder / "run" / "report.html").read_text()
    words = refused("evaluate", "comb-port", *base, "--out", "run")
    assert "metric own_waste:Waste: no module own_waste is installed or in" in words


@pytest.mark.usefixtures("unprinted")
def test_a_run_without_it_shows_a_dash(
    folder: Path, monkeypatch: pytest.MonkeyPatch, command: Callable[..., Any]
) -> None:
    """As one of ours is that is younger than the run."""
    with monkeypatch.context() as earlier:
        earlier.delitem(METRICS._registered, "cleared")
        run = played("run")
    assert "cleared" not in RunFolder(run).table("episodes").columns
    assert command("report", run).code == 0
    page = (run / "report.html").read_text()
    label = describe("cleared").label
    row = page[page.index(f">{label}<") :].split("</tr>", 2)[1]
    assert row.count(f">{number(math.nan, 3)}<") >= 3, row


def test_an_error_in_it_is_one_line(folder: Path) -> None:
    spoilt = SOURCE.replace("removed = batch.events.collected_at", "removed = batch.missing")
    (folder / "own_waste.py").write_text(spoilt)
    line = 1 + spoilt[: spoilt.index("batch.missing")].count("\n")
    words = (
        rf"^metric {OWN}: raised AttributeError: .*'missing' \(own_waste.py, line {line}\); mend"
    )
    with pytest.raises(UserError, match=words):
        played("run", OWN, jobs=2)


def test_its_source_is_part_of_the_run(folder: Path) -> None:
    run = played("run", OWN)
    assert "own_waste" in json.loads((run / "run.json").read_text())["code"]
    forget()
    (folder / "own_waste.py").write_text(SOURCE + "\n# edited\n")
    with pytest.raises(UserError, match=r"another run: code.own_waste is .*; give resume=.acc"):
        played("run", OWN)
    with pytest.raises(UserError, match=r"another run: metrics.left is true there and missing h"):
        played("run")


def test_another_one_of_the_same_file_is_another_run(folder: Path) -> None:
    """It was once left out without a word, as the file of both is the same."""
    other = SOURCE[SOURCE.index("class") :].replace("Waste", "More").replace('"left"', '"more"')
    (folder / "own_waste.py").write_text(f"{SOURCE}\n\n{other}")
    run = played("run", OWN)
    with pytest.raises(UserError, match=r"metrics.more is missing there and true here; give"):
        played("run", "own_waste:More")
    played("run", OWN, "own_waste:More", episodes=3, resume="accept-code-change")
    more = RunFolder(run).table("episodes")["more"].to_list()
    assert np.isnan(more).tolist() == [True, True, False]
    told = json.loads((run / "run.json").read_text())
    assert {"left", "more"} <= {one["key"] for one in told["metrics"]}
    assert told["accepted"][0]["differences"] == ["metrics.more is missing there and true here"]


def test_an_installed_one_is_part_of_the_runs_that_name_it_and_of_no_other(
    installed: Path, command: Callable[..., Any]
) -> None:
    plain, named = played("plain"), played("named", "left", jobs=2)
    assert "own-waste 1.2" in command("metrics").out
    assert "left" not in RunFolder(plain).table("episodes").columns
    assert "left" in RunFolder(named).table("episodes").columns
    assert "own_waste" in json.loads((named / "run.json").read_text())["code"]
    assert "own_waste" not in (plain / "run.json").read_text()
    uninstall(installed)
    played("plain")
    with pytest.raises(UserError, match="metric left: unknown"):
        played("named", "left")


def test_an_installed_one_that_is_broken_stops_no_run_and_no_list(
    installed: Path, command: Callable[..., Any]
) -> None:
    (installed.parent / "own_waste.py").write_text("import own_engine")
    played("run")
    assert "metric left: module own_waste needs own_engine" in command("metrics").out


@pytest.mark.usefixtures("unprinted")
def test_a_study_takes_it(folder: Path, command: Callable[..., Any]) -> None:
    varied = variants.ablation(setup().scenario, ["greedy"])
    found = run_study(
        Study("ablation", setup(), varied, episodes=1, metrics=(OWN,)), folder / "study"
    )
    assert found["complete"]["graph"]["greedy"]["left"]["n"] == 1
    assert command("report", folder / "study").code == 0


def test_one_of_the_script_itself_needs_one_process(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Local(Metric):
        key, label = "local", "Local"

        def value(self, batch: Any) -> Any:
            return batch.log.n_items

    monkeypatch.setitem(METRICS._registered, "local", Local)
    assert "local" not in RunFolder(played("without")).table("episodes").columns
    assert "local" in RunFolder(played("run", "local")).table("episodes").columns
    with pytest.raises(UserError, match=r"metric local: .*Local is defined in the script itself"):
        played("other", "local", jobs=2)
    assert not (folder / "other").exists()


@pytest.mark.parametrize("method", ["value", "series", "at"])
def test_a_formula_that_cannot_be_called_is_named_before_a_run(method: str) -> None:
    formula = {"value": lambda self, batch: batch.log.length, method: None}
    made = type("Odd", (Metric,), {"key": "odd", "label": "odd", **formula})
    with pytest.raises(UserError, match=f"^metric own:Odd: {method} is no method; define it"):
        checked(made, "own:Odd")


@pytest.mark.parametrize(
    ("attribute", "end"),
    [("least", "horizon"), ("least", float("inf")), ("most", "T"), ("most", True)],
)
def test_an_end_that_is_no_number_is_named_before_a_run(attribute: str, end: object) -> None:
    formula = {"value": lambda self, batch: batch.log.length, attribute: end}
    made = type("Odd", (Metric,), {"key": "odd", "label": "odd", **formula})
    with pytest.raises(UserError, match=f"^metric own:Odd: {attribute} = {end!r}: give a number"):
        checked(made, "own:Odd")
