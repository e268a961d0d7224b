"""Policies of a user's own folder: in other processes, with options, in films, by their source."""

import importlib
import json
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray

from mjforage.base import registry
from mjforage.base.errors import UserError
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.policies import register
from mjforage.graph_planner.policies.registry import POLICIES
from mjforage.mission.setup import Setup
from mjforage.mission.task import Observation, Task
from mjforage.runs.evaluate import evaluate
from mjforage.runs.replaying import recording_of_run
from mjforage.runs.storage import RunFolder
from mjforage.runs.studies import variants
from mjforage.runs.studies.study import Study, run_study
from mjforage.runs.workers import Workers
from mjforage.scenario.scenario_file import load_scenario
from mjforage.view.report.run_logs import load_logs
from mjforage.view.report.text_tables import headline_table

SOURCE = '''import numpy as np

from own_compass import NORTH


class North:
    """Always north, or another way."""

    def __init__(self, heading: int = NORTH) -> None:
        self.heading = heading

    def reset(self, task, keys):
        self.shape = (keys.size, len(task.fleet), 9)

    def act(self, observation):
        preferences = np.zeros(self.shape)
        preferences[..., self.heading] = 1.0
        return preferences


class Seer(North):
    """A bound."""

    def set_ground_truth(self, truth):
        pass
'''
NO_REPORT = """
import mjforage.view.report
mjforage.view.report.write_report = lambda folder, *_: folder / "report.html"
"""
"""Its seconds prove nothing here; tests of the report draw it."""
Start = Callable[..., "subprocess.Popen[str]"]
Forget = Callable[[], None]


def played(folder: str, *policies: str, jobs: int = 1, **options: Any) -> Path:
    """Two short episodes in a folder, without a report."""
    setup = Setup.of(load_scenario("comb-port", ["horizon=4"]))
    workers = options.pop("workers", Workers(jobs))
    evaluate(setup, policies, Path(folder), episodes=2, workers=workers, **options)
    return Path(folder)


@pytest.fixture
def forget() -> Forget:
    """Return what makes this process as good as new for the user's modules."""

    def forgotten() -> None:
        for name in [name for name in sys.modules if name.startswith("own_")]:
            del sys.modules[name]
        for name in [name for name in POLICIES._registered if name.startswith("own")]:
            del POLICIES._registered[name]

    return forgotten


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, forget: Forget) -> Iterator[Path]:
    """The present folder, with a module of policies and what it imports."""
    (tmp_path / "own_policies.py").write_text(SOURCE)
    (tmp_path / "own_compass.py").write_text("NORTH = 0\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(registry, "_TRUSTED", set())
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # stale if a file changes within a second
    path = list(sys.path)
    yield tmp_path
    sys.path[:] = path
    forget()


def info(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "run.json").read_text())
    return found


def tables(folder: Path) -> list[pl.DataFrame]:
    return [RunFolder(folder).table(name) for name in ("agents", "items", "episodes")]


@pytest.mark.parametrize("remote", [False, True])
def test_other_processes_play_it_to_the_same_bits(
    folder: Path, remote: bool, request: pytest.FixtureRequest
) -> None:
    address = request.getfixturevalue("scheduler") if remote else ""
    workers = Workers(1 if remote else 2, address)
    labels = ["own_policies:North", "own_policies:North(heading=2)"]
    one, two = played("one", *labels), played("two", *labels, workers=workers)
    for mine, theirs in zip(tables(one), tables(two), strict=True):
        assert mine.equals(theirs)
    moves = tables(two)[0].filter(pl.col("outcome") == "arrived")
    headings = moves.group_by("policy").agg(pl.col("direction").unique()).sort("policy").rows()
    assert [policy for policy, _ in headings] == labels
    assert [0 in found for _, found in headings] == [True, False]
    names = {path.name for path in (two / "replay").iterdir()}
    assert len(names) == 2 and not any(set(name) & set(":()= ") for name in names)


def test_its_source_is_part_of_the_run(folder: Path, forget: Forget) -> None:
    run = played("run", "own_policies:North")
    assert set(info(run)["code"]) == {"mjforage", "own_policies"}
    forget()
    source = (folder / "own_policies.py").read_text()
    (folder / "own_policies.py").write_text(source.replace("int = NORTH", "int = 4"))
    words = "code.own_policies is "
    with pytest.raises(UserError, match=f"another run: {words}.*; give resume=.accept-code"):
        played("run", "own_policies:North")
    before = tables(run)
    played("run", "own_policies:North", resume="accept-code-change")
    (note,) = info(run)["accepted"]
    assert note["differences"][0].startswith(words)
    assert tables(run)[0].equals(before[0])
    played("run", "own_policies:North", resume="fresh")
    assert "accepted" not in info(run) and not tables(run)[0].equals(before[0])
    (aside,) = folder.glob("run.before-*")
    assert tables(aside)[0].equals(before[0])


def test_options_are_part_of_the_run(folder: Path) -> None:
    run = played("run", "greedy(distance=0.0)")
    assert info(run)["policies"] == ["greedy(distance=0)"]
    played("run", "greedy(distance=0, item=5.91)")  # the same
    words = r'policies is \["greedy\(distance=0\)"\] there and \["greedy\(distance=1\)"\] here'
    with pytest.raises(UserError, match=words):
        played("run", "greedy(distance=1)")


def test_a_registered_name_is_played_again_by_a_process_that_has_not_its_module(
    folder: Path, forget: Forget
) -> None:
    (folder / "own_named.py").write_text(
        "from mjforage.graph_planner.policies import register\n"
        "from own_policies import North\n"
        "class Named(North):\n    pass\n"
        "register('own-name')(Named)\n"
    )
    sys.path.append(str(folder))
    importlib.import_module("own_named")
    sys.path.remove(str(folder))
    run = played("run", "own-name", jobs=2)
    forget()
    with pytest.raises(UserError, match="names policy own_named:Named, code that neither ships"):
        recording_of_run(run, None, None, 1)
    registry.trust("own_named:Named")
    replay = recording_of_run(run, None, None, 1)
    assert replay.policy == "own-name"


def test_a_bound_keeps_its_mark_where_its_module_is_gone(folder: Path, forget: Forget) -> None:
    run = played("run", "own_policies:Seer", "greedy")
    assert info(run)["bounds"] == ["own_policies:Seer"]
    forget()
    (folder / "own_policies.py").unlink()
    table = headline_table(load_logs(run))
    assert {row.head for row in table.rows if not row.paper} == {
        "own_policies:Seer (bound)",
        "greedy",
    }
    shutil.rmtree(run / "replay")
    with pytest.raises(UserError, match="no module own_policies is installed or in"):
        recording_of_run(run, None, "own_policies:Seer", 0)


def test_a_study_takes_it(folder: Path) -> None:
    setup = Setup.of(load_scenario("comb-port", ["horizon=4"]))
    players = ["own_policies:North(heading=0)"]
    study = Study("ablation", setup, variants.ablation(setup.scenario, players), episodes=1)
    found = run_study(study, folder / "study", workers=Workers(2))
    assert set(found["complete"]["graph"]) == {"own_policies:North"}
    run_study(study, folder / "study")
    (folder / "own_compass.py").write_text("NORTH = 4\n")
    run_study(study, folder / "study", resume="fresh")
    assert len(list(folder.glob("study.before-*"))) == 1


def test_the_first_policy_of_the_pages_runs_as_it_stands(folder: Path, start: Start) -> None:
    """Its file pasted, its command with two processes, on short episodes."""
    page = (Path(__file__).parents[3] / "docs" / "start.md").read_text()
    block = page.split("## A policy of your own", 1)[1]
    source = block.split("```python\n", 1)[1].split("```", 1)[0]
    given = block.split("```sh\nmjforage ", 1)[1].split("\n", 1)[0]
    name = block.split("`")[1]
    assert source.startswith(f"# {name}\n") and "--jobs 2" in given
    (folder / name).write_text(source)
    arguments = shlex.split(given.replace("--episodes 20", "--episodes 2 --set horizon=4"))
    assert "horizon=4" in arguments
    process = start(*arguments, before=NO_REPORT + "import sys; sys.path.remove('')")
    out, err = process.communicate(timeout=600)
    assert process.returncode == 0, err
    run = folder / arguments[-1]
    assert name.removesuffix(".py") in out and len(info(run)["policies"]) == 2


def test_a_policy_of_the_script_itself_needs_one_process(tmp_path: Path) -> None:
    @register("of-this-function")
    class Local:
        def reset(self, task: Task, keys: UInt64Array) -> None: ...
        def act(self, observation: Observation) -> NDArray[np.float64]:
            raise AssertionError

    setup = Setup.of(load_scenario("comb-port", ["horizon=4"]))
    with pytest.raises(UserError, match=r"policy of-this-function: .*Local is defined in the scr"):
        evaluate(setup, ["of-this-function"], tmp_path / "run", workers=Workers(2))
    assert not (tmp_path / "run").exists()


def test_an_error_in_a_policy_is_one_line_and_what_is_mended_goes_on_in_its_folder(
    folder: Path, forget: Forget
) -> None:
    spoilt = SOURCE.replace("preferences[..., self.heading]", "preferences[..., 14]")
    (folder / "own_policies.py").write_text(spoilt)
    line = 1 + spoilt[: spoilt.index("preferences[..., 14]")].count("\n")
    words = (
        r"policy own_policies:North: raised IndexError: index 14 is out of bounds .* "
        rf"\(own_policies.py, line {line}\); mend it"
    )
    for name, jobs in (("other", 2), ("run", 1)):
        with pytest.raises(UserError, match=words):
            played(name, "own_policies:North", jobs=jobs)
    (folder / "own_policies.py").write_text(SOURCE)
    forget()
    assert info(played("run", "own_policies:North"))["policies"] == ["own_policies:North"]
    assert [path.name for path in folder.glob("run*")] == ["run"]


def test_a_file_that_is_missing_is_named(folder: Path) -> None:
    source = SOURCE.replace('    """A bound."""\n', '    files = "net.bin"\n')
    (folder / "own_policies.py").write_text(source)
    with pytest.raises(UserError, match=r"own_policies:Seer: there is no file net.bin, which it"):
        played("run", "own_policies:Seer")
    (folder / "net.bin").write_text("weights")
    played("run", "own_policies:Seer")
