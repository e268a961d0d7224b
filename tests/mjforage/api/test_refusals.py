"""Wrong types, wrong names and impossible values: one line each, never an end of the process."""

import dataclasses
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mjforage as mf
from tests.mjforage.api.conftest import Eastward, nearest

ONE: dict[str, Any] = {"episodes": 1, "record": (), "progress": False}


class Mute:
    """Policy that answers in the wrong shape."""

    def reset(self, task: object, keys: object) -> None:
        pass

    def act(self, observation: object) -> object:
        return np.zeros(3)


class Uncopied(Eastward):
    """Policy that cannot be copied."""

    def __deepcopy__(self, memo: object) -> "Uncopied":
        raise TypeError("holds a lock")


def gives(answer: object) -> Callable[[mf.View], Any]:
    """A function that gives an answer."""
    return lambda view: answer


def fails(view: mf.View) -> dict[str, str]:
    """A function with a fault."""
    return {"scouts_0": [][0]}


async def slow(view: mf.View) -> None:
    """A function that returns no moves but a coroutine."""


def with_vessel(**changes: Any) -> mf.Scenario:
    """A scenario with a vessel of other parameters."""
    vessel = dataclasses.replace(mf.load_vessel("otter"), **changes)
    return mf.load_scenario("open-bay", physics={"vessels": {"foragers": vessel}})


def toward(place: Any) -> Callable[[mf.View], Any]:
    """A function that goes to a place."""
    return lambda view: {"scouts_0": view.toward("scouts_0", place)}


SCENARIOS: list[tuple[Any, dict[str, Any], str]] = [
    (3, {}, "scenario is int; give a name or a TOML file"),
    (None, {}, "scenario is NoneType"),
    ("", {}, "scenario : neither a shipped scenario"),
    ("comb-prot", {}, "did you mean comb-port"),
    ("missing.toml", {}, "missing.toml"),
    ("a\0b", {}, "scenario a"),
    ("comb-port", {"horizn": 3}, "unknown key horizn; did you mean horizon"),
    ("comb-port", {"horizon": "long"}, "horizon"),
    ("comb-port", {"horizon": 0}, "horizon"),
    ("comb-port", {"horizon": 1.5}, "horizon"),
    ("comb-port", {"horizon": None}, "horizon"),
    ("comb-port", {"horizon": [3]}, "horizon"),
    ("comb-port", {"horizon": object()}, "horizon"),
    ("comb-port", {"weather": 5.0}, "weather"),
    ("comb-port", {"weather": {"wind_sped_mps": 3}}, "did you mean weather.wind_speed_mps"),
    ("comb-port", {"weather": {"wind_speed_mps": -1}}, "wind_speed_mps"),
    ("comb-port", {"weather": {"wind_speed_mps": float("nan")}}, "wind_speed_mps"),
    ("comb-port", {"team": {"scouts": {"count": -1}}}, "count"),
    ("comb-port", {"team": {"scouts": {"count": 999}}}, "count"),
    ("comb-port", {"team": {"scouts": {"wheels": 4}}}, "wheels"),
    ("comb-port", {"link": {"range_m": 9.0}}, "link.range_m = 9.0 without a link"),
    ("comb-port", {"physics": {"vessels": {"scouts": 7}}}, "vessels"),
    ("comb-port", {"physics": {"vessels": {"nobody": "otter"}}}, "no such team"),
    ("comb-port", {"map": "nowhere"}, "map nowhere: neither a shipped map"),
    ("comb-port", {"map": np.zeros((4, 4), bool)}, "the array has no water"),
    ("comb-port", {"map": np.ones(4)}, "two axes"),
    ("comb-port", {"map": np.full((4, 4), "x")}, "two axes"),
    ("comb-port", {"map": [[1, 1], [1]]}, "no array"),
    ("comb-port", {"map": 5}, "two axes"),
    ("comb-port", {"map": np.eye(6)}, "separate components"),
    ("comb-port", {"map": "harbour:combs"}, "harbour"),
]
POLICIES: list[tuple[Any, str]] = [
    ("greedi", "did you mean greedy"),
    ("", "policy"),
    ([], "no policy given"),
    (3, "policy 3: is int; give a name"),
    (None, "policy None: is NoneType"),
    ([None], "policy None: is NoneType"),
    (["greedy", "greedy"], "policy greedy: given twice"),
    ("greedy(distance=far)", "distance"),
    ("greedy(speed=2)", "speed"),
    ("greedy(", "expected NAME"),
    ("nowhere:Policy", "nowhere"),
    ("json:JSONDecoder", "has no method reset"),
    ("model.zip", "such files hold pickles, which are code; load the model with its own class"),
    ("weights.safetensors", "there is no such file"),
    (lambda view: None, "policy '<lambda>': give it a name"),
    ({"a/b": nearest}, "policy 'a/b': give it a name"),
    ({"": nearest}, "policy ''"),
    ({"greedy": nearest}, "policy greedy: is the name of another"),
    ({"mine": "levi"}, "policy levi: unknown; did you mean levy"),
    ({"levy": "greedy"}, "policy levy: is the name of another"),
    (Mute(), "Mute"),
    (Uncopied(), "policy Uncopied: cannot be copied"),
    (int, "int"),
    (fails, r"policy fails: raised IndexError: list index out of range \(test_refusals.py, line"),
    ({"it": gives(5)}, "policy it: gave int; give a dict of agent -> move"),
    ({"it": gives("N")}, "policy it: gave str"),
    ({"it": gives({"scout_0": "N"})}, "gave a move for 'scout_0', no agent; did you mean scouts_0"),
    ({"it": gives({"scouts_0": "n"})}, "gave 'n' for scouts_0; give one of N, NE"),
    ({"it": gives({"scouts_0": 9})}, "gave 9 for scouts_0"),
    ({"it": gives({"scouts_0": -1})}, "gave -1 for scouts_0"),
    ({"it": gives({"scouts_0": True})}, "gave True for scouts_0"),
    ({"it": gives({"scouts_0": 1.0})}, "gave 1.0 for scouts_0"),
    ({"it": gives({0: "N"})}, "gave a move for 0, no agent"),
    ({"it": lambda view: view.nowhere}, "raised AttributeError"),
    ({"it": lambda: None}, r"takes 0 positional arguments but 1 was given; mend it"),
    ({"it": slow}, "policy it: is async; give a plain function"),
    ({"x" * 300: nearest}, "give it a name of letters and digits"),
    ({"it": toward(2.7)}, "raised TypeError: node is float; give a whole number"),
    ({"it": toward((0, 1.5))}, "raised TypeError: row and column is float"),
    ({"it": toward((0, 1, 2))}, "raised TypeError: node is tuple"),
    ({"it": toward(-1)}, "policy it: node -1: is no water"),
]
OPTIONS: list[tuple[dict[str, Any], str]] = [
    ({"episodes": 0}, "episodes 0"),
    ({"episodes": -1}, "episodes -1"),
    ({"episodes": "2"}, "episodes is str; give a whole number"),
    ({"episodes": 2.0}, "episodes is float; give a whole number"),
    ({"episodes": True}, "episodes is bool; give a whole number"),
    ({"seed": -1}, "seed -1"),
    ({"seed": 2**64}, "seed"),
    ({"seed": None}, "seed is NoneType; give a whole number"),
    ({"jobs": 0}, "jobs 0: give 1 or more"),
    ({"jobs": 1.5}, "jobs is float"),
    ({"world": "moon"}, "world 'moon': unknown"),
    ({"world": ()}, "world"),
    ({"world": ("graph", "graph")}, "world graph: given twice"),
    ({"world": 3}, "world"),
    ({"metrics": 5}, "metrics is 5"),
    ({"metrics": ["nowhere:Metric"]}, "nowhere"),
    ({"record": ["frist"]}, "frist"),
    ({"record": [99]}, "recorded episode 99: the run has episodes 0 to 0"),
    ({"resume": "maybe"}, "resume 'maybe'"),
    ({"horizn": 5}, "evaluate: no option or key of a scenario is horizn; did you mean horizon"),
    ({"epsiodes": 3}, "epsiodes; did you mean episodes"),
    ({"worlds": "graph"}, "worlds; did you mean world"),
    ({"n_jobs": 2}, "n_jobs; did you mean jobs"),
    ({"folder": 5}, "folder is int"),
    ({"progress": "yes"}, "progress"),
    ({"episodes": 2**63}, "episodes 9223372036854775808: give 1 to"),
    ({"record": [float("nan")]}, "record is float; give a whole number"),
    ({"record": None}, "record is NoneType; give a list"),
    ({"record": 1}, "record is int; give a list"),
    ({"metrics": None}, "metrics is None; give a list of names"),
    ({"scheduler": 5}, "scheduler is int"),
    ({"scheduler": "nowhere"}, "scheduler nowhere"),
]
CALLS: list[tuple[Callable[[mf.Scenario], Any], str]] = [
    (lambda bay: mf.load_run("nowhere"), "nowhere/run.json: file is missing"),
    (lambda bay: mf.load_run(5), "folder is int"),  # type: ignore[arg-type]
    (lambda bay: mf.compare(bay, "greedy", world="graph"), "compare takes no world"),
    (lambda bay: mf.make_mission(bay, world="moon"), "world 'moon': unknown"),  # type: ignore[arg-type]
    (lambda bay: mf.make_mission(bay, batch=0), "batch 0: give 1 or more"),
    (lambda bay: mf.make_mission(bay, batch=10**9), "memory"),
    (lambda bay: mf.names("polices"), "kind 'polices': unknown; did you mean policies"),  # type: ignore[arg-type]
    (lambda bay: mf.Map("nowhere"), "map nowhere: neither"),
    (lambda bay: mf.Map(np.ones((3, 3), bool), pitch_m=0.0), "pitch_m"),
    (lambda bay: mf.Map(np.ones((3, 3), bool), pitch_m=-4.0), "pitch_m"),
    (lambda bay: mf.Map(np.ones((3, 3), bool), starts=((9, 9),)), "start"),
    (lambda bay: bay.replace(map=mf.Map(np.ones((3, 3)), starts=((0, 0), (0, 0)))), "given twice"),
    (lambda bay: bay.to_file("/proc/nowhere/x.toml"), "/proc/nowhere"),
    (lambda bay: bay.map.to_file("/proc/nowhere/x.csv"), "/proc/nowhere"),
    (lambda bay: mf.Map("harbours:0-3"), "several maps, .* give one, such as harbour:combs:0"),
    (lambda bay: mf.Map("comb_port", water_is="dark"), "leave out map.water = dark"),
    (lambda bay: mf.parallel_env(set=["horizon"]), "set horizon: expected KEY=VALUE"),
    (lambda bay: mf.study("paper", bay, folder="s", options={"step": 0.3}), "step 0.3: give 1/N"),
    (lambda bay: mf.board(["open-bay"], overrides=["horizon"], folder="b"), "set horizon: exp"),
    (lambda bay: mf.load_vessel("oter"), "did you mean otter"),
    (lambda bay: mf.parallel_env(scenario="comb-prot"), "did you mean comb-port"),
    (lambda bay: mf.parallel_env(senario="comb-port"), "senario"),  # type: ignore[call-arg]
    (lambda bay: mf.load_run(None), "folder is NoneType; give a path"),  # type: ignore[arg-type]
    (lambda bay: mf.make_mission(bay, world=["graph"]), "world"),  # type: ignore[arg-type]
    (lambda bay: mf.make_mission(bay, batch="2"), "batch is str"),  # type: ignore[arg-type]
    (lambda bay: mf.make_mission(bay).reset(seed=1.5), "seed is float"),  # type: ignore[arg-type]
    (lambda bay: mf.make_mission(bay).reset(seed=None), "seed is"),  # type: ignore[arg-type]
    (lambda bay: mf.make_mission(bay).reset(episode="0"), "episode"),  # type: ignore[arg-type]
    (lambda bay: mf.make_mission(bay).play("greedy"), "no episode has been started"),
    (lambda bay: mf.Map(np.ones((3, 3)), starts=((1, 2, 3),)), "starts"),  # type: ignore[arg-type]
    (lambda bay: mf.Map(np.ones((3, 3)), starts="ab"), "starts"),  # type: ignore[arg-type]
    (lambda bay: mf.Map(np.ones((3, 3)), starts=((1.5, 1),)), "start is"),  # type: ignore[arg-type]
    (lambda bay: mf.Map(np.ones((3, 3)), pitch_m=True), "pitch_m is bool"),
    (lambda bay: mf.Map(np.ones((3, 3)), water_is="dark"), "water_is 'dark': is for files"),
    (lambda bay: mf.Map(np.ones((3, 3)), name=""), "name '': give letters"),
    (lambda bay: mf.Map(np.ones((3, 3)), name="a\nb"), "name 'a.*nb': give letters"),
    (lambda bay: mf.Mission("open-bay", "graph", None), "setup is str; make missions with"),  # type: ignore[arg-type]
    (lambda bay: setattr(mf.make_mission(bay), "agents", ()), "agents"),
    (lambda bay: mf.make_mission(bay).reset(episode=1.0), "episode is float; give"),  # type: ignore[arg-type]
    (lambda bay: mf.parallel_env(bay, observation=3), "observation = 3: give a name"),  # type: ignore[arg-type]
    (lambda bay: mf.Run("nowhere"), "nowhere/run.json: file is missing"),
    (lambda bay: with_vessel(name="../../esc"), "its name is that of a file"),
    (lambda bay: with_vessel(mass_kg=float("nan")), "vessel otter: mass_kg"),
    (lambda bay: with_vessel(mass_kg=-7.0), "vessel otter: mass_kg"),
    (lambda bay: with_vessel(mass_kg="7"), "vessel otter: mass_kg"),
    (lambda bay: bay.replace(map={"pitch": 3.0}), "map.pitch; did you mean map.pitch_m"),
    (lambda bay: mf.Map("comb-port", water_is="blue"), "blue"),  # type: ignore[arg-type]
    (lambda bay: mf.train("ddqn", bay, folder="it", updates=0), "updates 0: give 1 or more"),
    (lambda bay: mf.train("ddqn", bay, folder="it", hours="1"), "hours is str"),  # type: ignore[arg-type]
    (lambda bay: mf.train("ddqn", bay, folder=None), "folder is"),  # type: ignore[arg-type]
    (lambda bay: mf.board("open-bay", folder=5), "folder is int"),  # type: ignore[arg-type]
    (lambda bay: mf.study("relay", folder="it"), "study 'relay': unknown"),
    (lambda bay: mf.Study("nowhere"), "nowhere/study.json"),
    (lambda bay: setattr(bay, "episodes", 3), "cannot assign to field"),
    (lambda bay: setattr(bay.map, "colour", 3), "colour"),
]
RUNS: list[tuple[Callable[[mf.Run], Any], str]] = [
    (lambda run: run.frame(size=3), "size is 3; give"),  # type: ignore[arg-type]
    (lambda run: run.frame(size=(0, 9)), "size 0: give 1 or more"),
    (lambda run: run.frame(episode=0.5), "episode is float"),  # type: ignore[arg-type]
    (lambda run: run.frame(episode=7), "episode 7: give 0 to 0"),
    (lambda run: run.frame(time_s="1"), "time_s is str"),  # type: ignore[arg-type]
    (lambda run: run.frame("greedi"), "policy greedi: unknown"),
    (lambda run: run.frame(5), "policy is int"),  # type: ignore[arg-type]
    (lambda run: run.frame(world="moon"), "world moon"),
    (lambda run: run.frame(camera="moon"), "camera moon: unknown"),  # type: ignore[arg-type]
    (lambda run: run.frame(seen_by="nobody"), "nobody"),
    (lambda run: run.film("film.txt"), "film.txt"),
    (lambda run: run.film(5), "path is int"),  # type: ignore[arg-type]
    (lambda run: run.film("film.mp4", fps="fast"), "fps is str"),  # type: ignore[arg-type]
    (lambda run: run.film("film.mp4", duration_s=float("inf")), "duration_s = inf"),
    (lambda run: run.plot("pictures"), "figure 'pictures': unknown"),
    (lambda run: run.plot("gap"), "figure 'gap': unknown"),
    (lambda run: run.plot(["gap"]), "figure is list; give a name"),  # type: ignore[arg-type]
    (lambda run: run.frame(camera=["top"]), "camera is list; give a name"),  # type: ignore[arg-type]
    (lambda run: run.report(), "the run has no folder; give a path"),
    (lambda run: run.report("page.html", tables="latx"), "no format 'latx'"),
    (lambda run: run.report("page.html", policies="greedi"), "greedi: is not in this run"),
    (lambda run: run.save(None), "folder is NoneType"),  # type: ignore[arg-type]
    (lambda run: run.differences(), "give two policies"),
    (lambda run: run.differences("greedy", "levy"), "policy 'levy': unknown"),
    (lambda run: run.differences(world="moon"), "world 'moon': unknown"),
    (lambda run: run.differences(world=("graph", "graph", "graph")), "give one, or two"),  # type: ignore[arg-type]
    (lambda run: run.differences("greedy", "greedy", metrics="pta"), "metric 'pta': unknown"),
    (lambda run: pickle.dumps(run), "a Run is not pickled; give its folder"),
]


def test_there_are_a_hundred() -> None:
    assert len(SCENARIOS) + len(POLICIES) + len(OPTIONS) + len(CALLS) >= 100


OURS_OR_PYTHONS = r"[;:] (give|make)|assign to field|no (setter|attribute)|unexpected keyword"
"""A `TypeError` or `AttributeError` is one of ours, or Python's own of a signature or attribute."""


def refused(call: Callable[[], Any], words: str) -> None:
    """A call is refused in one line without flags, by an exception of the family."""
    family = (mf.UserError, TypeError, AttributeError)
    with pytest.raises(family, match=words) as caught:
        call()
    said = str(caught.value)
    assert not re.search(r"\n|(?<!\()--[a-z]", said)
    assert isinstance(caught.value, mf.UserError) or re.search(OURS_OR_PYTHONS, said)


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(("name", "changes", "words"), SCENARIOS)
def test_scenarios(name: Any, changes: dict[str, Any], words: str) -> None:
    refused(lambda: mf.load_scenario(name, **changes), words)


@pytest.mark.parametrize(("policy", "words"), POLICIES)
def test_policies(bay: mf.Scenario, policy: Any, words: str) -> None:
    refused(lambda: mf.evaluate(bay, policy, **ONE), words)


@pytest.mark.parametrize(("options", "words"), OPTIONS)
def test_options(bay: mf.Scenario, options: dict[str, Any], words: str) -> None:
    refused(lambda: mf.evaluate(bay, "greedy", **{**ONE, **options}), words)


@pytest.mark.parametrize(("call", "words"), CALLS)
def test_calls(bay: mf.Scenario, call: Callable[[mf.Scenario], Any], words: str) -> None:
    refused(lambda: call(bay), words)


@pytest.fixture(scope="module")
def run(bay: mf.Scenario) -> mf.Run:
    return mf.evaluate(bay, "greedy", **ONE)


@pytest.mark.parametrize(("call", "words"), RUNS)
def test_runs(run: mf.Run, call: Callable[[mf.Run], Any], words: str) -> None:
    refused(lambda: call(run), words)
