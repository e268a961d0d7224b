"""Runs of policies in every form: the same numbers through every door."""

import importlib
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from polars.testing import assert_frame_equal

import mjforage as mf
from mjforage.base import registry
from mjforage.cli.commands import app
from mjforage.runs.costs import load_costs
from mjforage.runs.layout import chunk_size
from mjforage.runs.sources import source_hash
from tests.mjforage.api.conftest import Eastward, drawn, nearest

QUIET: dict[str, Any] = {"record": (), "progress": False}
CHUNK = chunk_size("graph")  # one episode more is two chunks, which go to workers
SOON_S = 20.0  # on a busy machine; a second on a free one
TWO_CHUNKS = CHUNK + 1


def test_a_function_an_object_and_a_class_play_beside_a_name(bay: mf.Scenario) -> None:
    forms = {"nearest": nearest, "east": Eastward, "west": Eastward(6)}
    run = mf.evaluate(bay, forms, episodes=2, **QUIET)
    assert run.policies == ("nearest", "east", "west")
    moved = run.agents.filter(pl.col("step") > 0).group_by("policy").agg(pl.col("x_m").mean())
    east, west = (moved.filter(policy=name)["x_m"].item() for name in run.policies[1:])
    assert east > west


def test_a_function_does_what_a_class_would(bay: mf.Scenario) -> None:
    run = mf.evaluate(
        bay,
        {"by-function": lambda view: dict.fromkeys(view.agents, "E"), "by-class": Eastward()},
        episodes=3,
        **QUIET,
    )
    one, other = (run.agents.filter(policy=name).drop("policy") for name in run.policies)
    assert_frame_equal(one, other)


def test_workers_change_no_number(bay: mf.Scenario) -> None:
    forms: list[Any] = [nearest, drawn, Eastward(4)]
    one, two = (
        mf.evaluate(bay, forms, episodes=3, world=("graph",), jobs=jobs, seed=5, **QUIET)
        for jobs in (1, 2)
    )
    for table in ("episodes", "steps", "agents", "items"):
        assert_frame_equal(getattr(one, table), getattr(two, table))


def in_workers(folder: Path) -> bool:
    """True if other processes than this one simulated all episodes of a run."""
    here = f"{socket.gethostname()}-{os.getpid()}"
    return here not in {cost.worker for cost in load_costs(folder / "costs.json")}


def test_a_redefined_function_is_the_new_one_in_workers_that_stay(
    bay: mf.Scenario, tmp_path: Path
) -> None:
    def ends(move: str) -> pl.DataFrame:
        def steer(view: mf.View) -> dict[str, str]:
            return dict.fromkeys(view.agents, move)

        folder = Path(tempfile.mkdtemp(dir=tmp_path))
        run = mf.evaluate(bay, steer, episodes=TWO_CHUNKS, jobs=2, folder=folder, **QUIET)
        assert in_workers(folder)
        return run.agents

    east, west, again = (ends(move) for move in "EWE")
    assert_frame_equal(east, again)
    assert not east["x_m"].equals(west["x_m"])


def test_the_command_line_and_a_loop_of_steps_give_equal_bits(
    bay: mf.Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    bay.to_file("bay.toml")
    how = ["--policy", "greedy", "--episodes", "2", "--seed", "7", "--replay", "none"]
    app(["evaluate", "bay.toml", *how, "--out", "run"], result_action="return_value")
    mine = mf.evaluate(bay, "greedy", episodes=2, seed=7, **QUIET)
    for table in ("episodes", "steps", "agents", "items"):
        assert_frame_equal(getattr(mine, table), getattr(mf.load_run("run"), table))
    mission = mf.make_mission(bay)
    for episode in range(2):
        mission.reset(seed=7, episode=episode)
        places = np.stack([state.agent_xy_m for state in mission.play("greedy")])
        logged = mine.agents.filter(pl.col("step") > 0, episode=episode)
        assert (logged.select("x_m", "y_m").to_numpy() == places.astype("f4").reshape(-1, 2)).all()


def test_a_folder_is_resumed_and_in_memory_nothing_stays(
    bay: mf.Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "t"))
    (tmp_path / "t").mkdir()
    run = mf.evaluate(bay, nearest, episodes=2, **QUIET)
    assert run.folder is None and list((tmp_path / "t").iterdir())
    del run
    assert not list((tmp_path / "t").iterdir())
    folder = tmp_path / "run"
    first = mf.evaluate(bay, nearest, episodes=2, folder=folder, **QUIET)
    more = mf.evaluate(bay, nearest, episodes=3, folder=folder, **QUIET)
    assert first.folder == more.folder == folder
    assert_frame_equal(
        more.episodes.head(2), mf.evaluate(bay, nearest, episodes=2, **QUIET).episodes
    )


def test_another_function_of_the_name_is_another_run(bay: mf.Scenario, tmp_path: Path) -> None:
    mf.evaluate(bay, {"mine": nearest}, episodes=1, folder=tmp_path / "run", **QUIET)
    with pytest.raises(mf.UserError, match="run: holds another run"):
        mf.evaluate(bay, {"mine": drawn}, episodes=1, folder=tmp_path / "run", **QUIET)
    with pytest.raises(mf.UserError, match="run: holds another run"):
        mf.evaluate(bay, {"mine": Eastward(1)}, episodes=1, folder=tmp_path / "run", **QUIET)
    mf.evaluate(bay, {"thine": Eastward(1)}, episodes=1, folder=tmp_path / "object", **QUIET)
    with pytest.raises(mf.UserError, match="object: holds another run"):
        mf.evaluate(bay, {"thine": Eastward(2)}, episodes=1, folder=tmp_path / "object", **QUIET)


def test_fresh_keeps_another_run_aside(bay: mf.Scenario, tmp_path: Path) -> None:
    how: dict[str, Any] = {"episodes": 1, "folder": tmp_path / "run", **QUIET}
    mf.evaluate(bay, "levy", **how)
    assert mf.evaluate(bay, "random", resume="fresh", **how).policies == ("random",)
    [aside] = tmp_path.glob("run.before-*")
    assert mf.load_run(aside).policies == ("levy",)


def test_numbers_may_be_of_numpy(bay: mf.Scenario) -> None:
    how: dict[str, Any] = {"episodes": np.int64(1), "seed": np.uint64(7)}
    run = mf.evaluate(bay, "levy", **how, **QUIET)
    assert run.seed == 7 and run.episodes.height == 1


class OneBatch(Eastward):
    """Goes east in the first batch that an object plays, west in others."""

    def reset(self, task: Any, keys: Any) -> None:
        super().reset(task, keys)
        self.move = 6


def test_every_batch_has_a_copy_of_an_object(bay: mf.Scenario) -> None:
    given = OneBatch()
    run = mf.evaluate(bay, [given], episodes=TWO_CHUNKS, **QUIET)
    ends = run.agents.filter(step=1)["x_m"] - run.agents.filter(step=0)["x_m"]
    assert ends.len() == TWO_CHUNKS * 4 and (ends > 0.0).all() and given.move == 2


def test_ctrl_c_returns_what_is_finished(bay: mf.Scenario) -> None:
    def stop(done: int, total: int) -> None:
        if done >= 100:
            raise KeyboardInterrupt

    run = mf.evaluate(bay, "random", episodes=120, progress=stop, record=())
    assert not run.complete and run.episodes["episode"].sort().to_list() == list(range(100))
    assert run.summary.filter(metric="pta_c")["n"].to_list() == [100]
    assert repr(run).endswith("not complete)")
    with pytest.raises(mf.UserError, match="the run is not complete"):
        run.plot()


PROGRAM = """
import signal, sys
import mjforage as mf
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have switched it off
folder, jobs = sys.argv[1], int(sys.argv[2])
found = mf.{call}, folder=folder, episodes=20_000, jobs=jobs, progress=lambda done, total: (
    print(done, flush=True)
))
print("returned", found.complete, found.summary["n"].max())
"""
CALLS = ('evaluate("comb-port", "greedy"', 'study("ablation", "comb-port", "greedy"')


@pytest.mark.skipif(os.name != "posix", reason="needs signals")
@pytest.mark.parametrize(("call", "jobs"), [(CALLS[0], 1), (CALLS[0], 2), (CALLS[1], 2)])
def test_ctrl_c_from_a_terminal_returns_soon(call: str, jobs: int, tmp_path: Path) -> None:
    """The signal goes to the process and its workers; whole, the call takes a minute or more."""
    with subprocess.Popen(
        [sys.executable, "-c", PROGRAM.format(call=call), str(tmp_path / "run"), str(jobs)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        assert process.stdout is not None
        while int(process.stdout.readline()) < CHUNK:
            pass
        os.killpg(process.pid, signal.SIGINT)
        out, err = process.communicate(timeout=SOON_S)
    assert (process.returncode, err) == (0, "")
    word, complete, episodes = out.splitlines()[-1].split()
    assert (word, complete) == ("returned", "False")
    assert CHUNK <= int(episodes) < 20_000


def test_compare_plays_both_worlds(bay: mf.Scenario) -> None:
    gap = mf.compare(bay, nearest, episodes=1, **QUIET)
    assert gap.worlds == ("graph", "physics")
    ladder = mf.compare(bay.replace(horizon=2), nearest, episodes=1, ladder=True, **QUIET)
    assert ladder.worlds[0] == "graph" and len(ladder.worlds) > 2


def test_compare_records_the_episodes_asked_for(bay: mf.Scenario, tmp_path: Path) -> None:
    how: dict[str, Any] = {"episodes": 2, "record": [1], "progress": False, "horizon": 2}
    mf.compare(bay, "levy", folder=tmp_path / "run", **how)
    files = sorted(file.name for file in tmp_path.glob("run/replay/*.npz"))
    assert files == ["graph-levy-1.npz", "physics-levy-1.npz"]


def test_weights_of_any_folder_are_played_by_their_path(bay: mf.Scenario, tmp_path: Path) -> None:
    from mjforage.scenario.assets import models_folder

    shipped = models_folder() / "weights" / "ddqn.safetensors"
    path = tmp_path / "mine.safetensors"
    path.write_bytes(shipped.read_bytes())
    port = mf.load_scenario("comb-port", horizon=6)
    run = mf.evaluate(port, [path, "ddqn"], episodes=1, **QUIET)
    mine, theirs = (run.agents.filter(policy=name).drop("policy") for name in ("mine", "ddqn"))
    assert_frame_equal(mine, theirs)


class Base:
    """What a policy may stand on."""

    move = "N"

    def steer(self, view: mf.View) -> dict[str, str]:
        return dict.fromkeys(view.agents, self.move)


def test_whatever_a_policy_uses_is_part_of_what_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """Values of names in comprehensions, of objects, of base classes, of partial functions."""
    moves = {"move": "N"}

    def steer(view: mf.View) -> dict[str, str]:
        return dict.fromkeys(view.agents, moves["move"])

    def by(move: str, view: mf.View) -> dict[str, str]:
        return dict.fromkeys(view.agents, move)

    other = Base()
    other.move = "S"
    child = type("Child", (Base,), {"__module__": "__main__"})
    before = [source_hash(one) for one in (steer, Base().steer, partial(by, "N"), child)]
    again = [source_hash(one) for one in (steer, Base().steer, partial(by, "N"), child)]
    moves["move"] = "S"
    monkeypatch.setattr(Base, "move", "E")
    after = [source_hash(one) for one in (steer, other.steer, partial(by, "S"), child)]
    assert before == again
    assert all(one != two for one, two in zip(before, after, strict=True))
    north, south = (lambda v: "N"), (lambda v: "S")
    assert source_hash(north) != source_hash(south)
    assert not any(one.startswith("unreadable") for one in before)

    def of_default(move: str) -> Callable[[mf.View], dict[str, str]]:
        def go(view: mf.View, move: str = move) -> dict[str, str]:
            return dict.fromkeys(view.agents, move)

        return go

    assert source_hash(of_default("N")) == source_hash(of_default("N"))
    assert source_hash(of_default("N")) != source_hash(of_default("S"))


def test_workers_have_modules_of_a_user_as_they_are_here(
    bay: mf.Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "own_steering.py").write_text(
        "MOVE = 'E'\ndef steer(view):\n    return {agent: MOVE for agent in view.agents}\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    own = importlib.import_module("own_steering")
    for move in "EW":
        own.MOVE = move  # type: ignore[attr-defined]
        folder = tmp_path / move
        one = mf.evaluate(bay, own.steer, episodes=TWO_CHUNKS, **QUIET)
        two = mf.evaluate(bay, own.steer, episodes=TWO_CHUNKS, jobs=2, folder=folder, **QUIET)
        assert in_workers(folder)
        assert_frame_equal(one.agents, two.agents)


@pytest.mark.parametrize("jobs", [1, 2])
def test_errors_of_a_class_are_one_line(bay: mf.Scenario, jobs: int) -> None:
    class Broken(Eastward):
        def act(self, observation: Any) -> Any:
            sys.exit(f"on\ntwo lines of {os.getpid()},")

    how: dict[str, Any] = {"episodes": TWO_CHUNKS, "jobs": jobs, **QUIET}
    forms: dict[str, Any] = {"Broken": [Broken], "thing": {"thing": Broken()}}
    for name, given in forms.items():
        line = rf"policy {name}: raised SystemExit: on two lines of (\d+),"
        with pytest.raises(mf.UserError, match=line) as caught:
            mf.evaluate(bay, given, **how)
        process = re.search(line, str(caught.value))
        assert process and (int(process[1]) == os.getpid()) == (jobs == 1)


def test_nothing_stays_of_a_call_that_is_refused(
    bay: mf.Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with pytest.raises(mf.UserError):
        mf.evaluate(bay, "greedi", episodes=1, **QUIET)
    assert not list(tmp_path.iterdir())


def test_a_run_of_a_function_is_filmed_by_whoever_gives_it(
    bay: mf.Scenario, tmp_path: Path
) -> None:
    mf.evaluate(bay, {"later": nearest}, episodes=1, folder=tmp_path / "run", **QUIET)
    with pytest.raises(mf.UserError, match=r"give it, as in load_run\(folder, policies="):
        mf.load_run(tmp_path / "run").frame("later")
    run = mf.load_run(tmp_path / "run", policies={"later": nearest})
    assert run.frame("later", size=(320, 180)).shape == (180, 320, 3)


def test_a_loaded_run_imports_only_code_that_is_named(
    bay: mf.Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "named_east.py").write_text(
        "from tests.mjforage.api.conftest import Eastward\n\n\nclass East(Eastward):\n    pass\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(registry, "_TRUSTED", set())
    mf.evaluate(bay, "named_east:East", episodes=1, folder=tmp_path / "run", **QUIET)
    monkeypatch.setattr(registry, "_TRUSTED", set())  # as in another process
    with pytest.raises(mf.UserError, match="names policy named_east:East, code that neither ships"):
        mf.load_run(tmp_path / "run").recording()
    named = mf.load_run(tmp_path / "run", policies="named_east:East")
    assert named.recording().policy == "named_east:East"


def test_calls_on_two_threads_play_their_own_functions(bay: mf.Scenario) -> None:
    both = threading.Barrier(2)

    def going(move: str) -> mf.Run:
        def steer(view: mf.View) -> dict[str, str]:
            if view.step == 1:
                both.wait(60)
            return dict.fromkeys(view.agents, move)

        return mf.evaluate(bay, steer, episodes=1, **QUIET)

    with ThreadPoolExecutor(2) as pool:
        east, west = pool.map(going, ("E", "W"))
    assert east.agents["x_m"].sum() > west.agents["x_m"].sum()


def test_a_call_within_a_call_keeps_the_outer_ones_policies(bay: mf.Scenario) -> None:
    inner: list[mf.Run] = []

    def outer(view: mf.View) -> dict[str, str]:
        if not inner:
            inner.append(mf.evaluate(bay, {"inner": drawn}, episodes=1, **QUIET))
        return {}

    run = mf.evaluate(bay, [outer, drawn], episodes=1, **QUIET)
    assert run.policies == ("outer", "drawn") and inner[0].policies == ("inner",)


def test_a_policy_under_another_name_is_that_policy(bay: mf.Scenario) -> None:
    wide = {"greedy": "greedy", "near": "greedy(distance=2)", "far": lambda view: {}}
    run = mf.evaluate(bay, wide, episodes=2, jobs=2, **QUIET)
    plain = mf.evaluate(bay, "greedy(distance=2)", episodes=2, **QUIET)
    mine = run.agents.filter(policy="near").drop("policy")
    assert run.policies == ("greedy", "near", "far")
    assert_frame_equal(mine, plain.agents.drop("policy"))
