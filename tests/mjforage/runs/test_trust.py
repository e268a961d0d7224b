"""Names that stand in files of anybody: no code of them runs, but what the user names too."""

import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import polars as pl
import pytest

from mjforage.base import registry
from mjforage.base.errors import UserError
from mjforage.cli import main
from mjforage.graph_planner.networks.weights import Q_NETWORK
from mjforage.graph_planner.policies.registry import POLICIES, create_policy, policy_names
from mjforage.mission.setup import Setup
from mjforage.runs import jobs
from mjforage.runs.costs import Invocation
from mjforage.runs.evaluate import evaluate
from mjforage.runs.jobs import Job
from mjforage.runs.replaying import recording_of_run
from mjforage.runs.workers import Workers
from mjforage.scenario.scenario_file import load_scenario
from mjforage.view.report.run_logs import load_logs

EVIL = """from pathlib import Path

Path("imported").touch()


class Enc:
    def __init__(self, *given):
        Path("called").touch()

    def reset(self, *given):
        Path("called").touch()

    see = act = reset
"""
MINE = """import numpy as np


class North:
    def reset(self, task, keys):
        self.shape = (keys.size, len(task.fleet), 9)

    def act(self, observation):
        preferences = np.zeros(self.shape)
        preferences[..., 0] = 1.0
        return preferences
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The present folder, with a module that tells of every import and call."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    monkeypatch.setattr(registry, "_TRUSTED", set())
    (tmp_path / "evil.py").write_text(EVIL)
    (tmp_path / "trust_mine.py").write_text(MINE)
    path, known = list(sys.path), dict(POLICIES._registered)
    yield tmp_path
    sys.path[:] = path
    POLICIES._registered.clear()
    POLICIES._registered.update(known)
    for name in {"evil", "trust_mine"} & set(sys.modules):
        del sys.modules[name]


def run_of(*policies: str) -> Path:
    """A run of a short episode."""
    setup = Setup.of(load_scenario("comb-port", ["horizon=4"]))
    evaluate(setup, policies, Path("run"), episodes=1, kept=())
    return Path("run")


def rewritten(run: Path, **changes: object) -> None:
    file = run / "run.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | changes))


def untouched(folder: Path) -> bool:
    return not any((folder / name).exists() for name in ("pwned", "imported", "called"))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"policies": ['subprocess:getoutput(cmd="touch pwned")']}, "add --trust subprocess:geto"),
        ({"policies": ["evil:Enc"]}, "add --trust evil:Enc"),
        ({"policies": ["named"], "classes": {"named": "evil:Enc"}}, "add --trust evil:Enc"),
        ({"policies": ["evil:Enc"], "classes": {"evil:Enc": "evil"}}, "add --trust evil:Enc"),
    ],
)
def test_a_run_folder_runs_no_code(folder: Path, changes: dict[str, object], words: str) -> None:
    run = run_of("greedy")
    rewritten(run, **changes)
    with pytest.raises(UserError, match=words) as caught:
        recording_of_run(run, None, None, 0)
    assert str(run / "run.json") in str(caught.value) and "\n" not in str(caught.value)
    assert untouched(folder)


def test_a_place_in_a_file_never_stands_for_a_known_name(folder: Path) -> None:
    run = run_of("greedy")
    rewritten(run, classes={"greedy": "evil:Enc"})
    assert recording_of_run(run, None, None, 0).policy == "greedy"
    assert untouched(folder)


@pytest.mark.parametrize(
    "flags", [["--policy", "trust_mine:North"], ["--trust", "trust_mine:North"]]
)
def test_the_users_own_word_lets_it(
    folder: Path, flags: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    run_of("trust_mine:North")
    monkeypatch.setattr(registry, "_TRUSTED", set())  # as in another process
    with pytest.raises(SystemExit):
        main(["render", "run", "-o", "x.png"])
    main(["render", "run", "-o", "x.png", *flags])
    assert (folder / "x.png").is_file()


def test_a_run_of_ones_own_goes_on_by_the_same_command(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = run_of("trust_mine:North")
    monkeypatch.setattr(registry, "_TRUSTED", set())
    (run / "summary.json").unlink()
    run_of("trust_mine:North")
    assert (run / "summary.json").is_file()


def test_weights_run_no_code(folder: Path) -> None:
    notes = {"perception": "evil:Enc", "format": Q_NETWORK, "shapes": {"a": [1]}}
    header = json.dumps({"__metadata__": {"mjforage": json.dumps(notes)}}).encode()
    (folder / "mine.safetensors").write_bytes(len(header).to_bytes(8, "little") + header)
    with pytest.raises(UserError, match=r"mine.safetensors: .*add --trust evil:Enc"):
        create_policy("mine")
    assert untouched(folder)
    registry.trust("evil:Enc")
    create_policy("mine")
    assert (folder / "imported").exists() and not (folder / "called").exists()


def test_reports_run_no_code(folder: Path) -> None:
    """Of metrics that only a table names."""
    run = run_of("greedy")
    for table in ("episodes", "steps"):
        frame = pl.read_parquet(run / f"{table}.parquet")
        frame.with_columns(frame["pta_c"].alias("evil:Enc")).write_parquet(run / f"{table}.parquet")
    summary = json.loads((run / "summary.json").read_text())
    found = summary["graph"]["greedy"]
    found["evil:Enc"] = found["pta_c"]
    (run / "summary.json").write_text(json.dumps(summary))
    logs = load_logs(run)
    assert logs.metrics["evil:Enc"].label == logs.series["evil:Enc"].label == "evil:Enc"
    assert untouched(folder)


def test_workers_take_what_their_parent_was_told(folder: Path) -> None:
    registry.trust("trust_mine:North")
    setup, here = Setup.of(load_scenario("comb-port", ["horizon=4"])), Invocation("", "", 1)
    info = {"hash": "", "seed": 0, "policies": ["greedy"], "worlds": ["graph"]}
    work = Job.of(setup, folder, info, (), here, Workers(2))
    assert work.trusted == ("trust_mine:North",)
    registry._TRUSTED.clear()
    jobs._setup(replace(work, parent=1, code=()))
    assert registry.trusted() == ("trust_mine:North",)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ('subprocess:getoutput(cmd="touch pwned")', "is a function; give a class"),
        ('subprocess:Popen(args="touch pwned", shell=true)', "has no method reset; define it"),
        ("evil:Path", "has no method reset; define it"),
    ],
)
def test_nothing_is_called_that_is_no_class_of_policies(
    folder: Path, name: str, words: str
) -> None:
    with pytest.raises(UserError, match=words):
        create_policy(name)
    assert not (folder / "pwned").exists()
    assert name not in policy_names()


def test_what_is_no_reference_cannot_be_trusted() -> None:
    with pytest.raises(UserError, match=r"evil: expected package.module:Name"):
        registry.trust("evil")


def test_workers_of_the_command_import_nothing_of_the_present_folder(folder: Path) -> None:
    for name in ("joblib", "multiprocessing", "numpy"):
        (folder / f"{name}.py").write_text(EVIL)
    command = Path(sys.executable).with_name("mjforage")
    run = ("evaluate", "comb-port", "--policy", "greedy", "--policy", "levy", "--jobs", "2")
    few = ("--episodes", "2", "--set", "horizon=2", "--replay", "none", "--out", "run")
    done = subprocess.run([command, *run, *few], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert not (folder / "imported").exists()
