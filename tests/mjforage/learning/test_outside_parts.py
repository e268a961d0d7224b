"""Reward terms and observation encoders of a user's own folder, wherever ours are named."""

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AsyncVectorEnv

import mjforage
from mjforage.base.errors import UserError
from mjforage.graph_planner.encodings import ENCODERS
from mjforage.graph_planner.networks.weights import read_header
from mjforage.learning.environments.rewards import REWARDS
from mjforage.learning.training.hyperparameters import Hyperparameters, changed
from mjforage.learning.training.run import train
from mjforage.mission.setup import Setup
from mjforage.runs.evaluate import evaluate
from mjforage.runs.fingerprint import outside_code
from mjforage.scenario.scenario_file import load_scenario

ENCODER = '''import numpy as np


class Clock:
    """Steps that are left."""

    def __init__(self, task, bins: int = 4) -> None:
        if bins < 0:
            raise ValueError(f"bins = {bins}: give 0 or more")
        self.task, self.shapes = task, {"clock": (bins,)}

    def reset(self, episodes):
        self.out = np.zeros((episodes, len(self.task.fleet), *self.shapes["clock"]), np.uint8)

    def see(self, seen, rows):
        left = 1.0 - (seen.step[rows] - 1) / self.task.horizon
        self.out[rows] = (255 * left).astype(np.uint8)[:, None, None]
        return {"clock": self.out}
'''
TERM = '''import numpy as np


class Southing:
    """Nodes made good to the south."""

    def __init__(self, scale: float = 1.0) -> None:
        if scale == 0:
            raise ValueError("scale = 0: give another")
        self.scale = scale

    def __call__(self, step):
        rows = step.task.graph.rows
        made = rows[step.mission.state.agent_node] - rows[step.before.agent_node]
        return self.scale * made.astype(np.float64)


class Flat(Southing):
    def __call__(self, step):
        return super().__call__(step)[0]


class Endless(Southing):
    def __call__(self, step):
        return super().__call__(step) * np.nan
'''
POLICY = """import numpy as np

from mjforage.learning.model_policy import ModelPolicy


class Late(ModelPolicy):
    observation = "own_encoder:Clock(bins=3)"

    def decide(self, seen, agents):
        assert seen["clock"].shape[1:] == (3,)
        return np.full(agents.size, 8)
"""
SHORT = ("horizon=6",)
CLOCK, SOUTH = "own_encoder:Clock(bins=3)", "own_term:Southing(scale=2)"
TINY = {
    "num_envs": 2,
    "batch": 4,
    "capacity": 1000,
    "warmup": 8,
    "evaluate_every": 1000,
    "evaluate_episodes": 1,
    "observation": CLOCK,
    "reward.own_term:Southing(scale=2.0)": 0.5,
}


def forget() -> None:
    for name in [name for name in sys.modules if name.startswith("own_")]:
        del sys.modules[name]
    outside_code.cache_clear()


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The present folder, with an encoder, terms, and a policy."""
    for name, text in (("own_encoder", ENCODER), ("own_term", TERM), ("own_model", POLICY)):
        (tmp_path / f"{name}.py").write_text(text)
    monkeypatch.chdir(tmp_path)
    path = list(sys.path)
    yield tmp_path
    sys.path[:] = path
    forget()


def options(**others: Any) -> dict[str, Any]:
    return {"set": SHORT, "observation": CLOCK, "reward": {SOUTH: 3.0, "time": -1.0}} | others


def test_an_environment_takes_them_by_name_and_options(folder: Path) -> None:
    env = gymnasium.make("mjforage/Foraging-v0", **options())
    seen, _ = env.reset(seed=1)
    assert seen["clock"].shape == (4, 3) and (seen["clock"] == 1.0).all()
    core: Any = env.unwrapped
    core = core.core
    rows = core.setup.graph.rows
    before = rows[core.mission.state.agent_node].sum()
    seen, reward, *_, info = env.step(np.full(4, 4))
    made = int(rows[core.mission.state.agent_node].sum() - before)
    assert made > 0 and info[f"reward/{SOUTH}"] == 6.0 * made
    assert reward == pytest.approx(6.0 * made - 4.0)
    assert env.observation_space.contains(seen) and (seen["clock"] < 1.0).all()


def environment() -> gymnasium.Env[Any, Any]:
    return gymnasium.make("mjforage/Foraging-v0", **options())


def test_worker_processes_find_them(folder: Path) -> None:
    """A fresh process, which has only the names."""
    vector = AsyncVectorEnv([environment], context="spawn")
    seen, _ = vector.reset(seed=1)
    alone, _ = environment().reset(seed=1)
    np.testing.assert_array_equal(seen["clock"][0], alone["clock"])
    assert f"reward/{SOUTH}" in vector.step(np.full((1, 4), 4))[-1]
    vector.close()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"observation": "own_encoder:Clok"}, "own_encoder has no Clok; did you mean Clock"),
        ({"observation": "own_model:Prefer"}, "own_model has no Prefer; choose Late"),
        ({"observation": "own_encoder:Clock(side=1)"}, "unknown option side; "),
        ({"observation": "own_encoder:Clock(task=1)"}, "unknown option task; "),
        ({"observation": "own_term:Southing"}, "observation own_term:Southing: is no encoder"),
        ({"observation": "own_encoder:Clock(bins=0)"}, "shapes = {'clock': .0,.}; give a dict"),
        ({"observation": "own_encoder:Clock(bins=-1)"}, r"Clock\(bins=-1\): bins = -1: give 0 or"),
        ({"reward": {"own_term:Southing(scale=0)": 1.0}}, r"\(scale=0\): scale = 0: give ano"),
        ({"reward": {"own_encoder:Clock": 1.0}}, "option task is missing"),
        ({"reward": {"own_model:Late": 1.0}}, "reward own_model:Late: is no term; give a class"),
        ({"reward": {SOUTH: 1.0, "own_term:Southing(scale=2.0)": 1.0}}, "given twice"),
        ({"reward": {"own_term:Southing(scale=big)": 1.0}}, "option scale = big: expected float"),
    ],
)
def test_what_is_none_is_one_line(folder: Path, given: dict[str, Any], words: str) -> None:
    with pytest.raises(UserError, match=words) as caught:
        mjforage.parallel_env(**options(**given))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("term", "words"),
    [
        ("Flat", r"reward own_term:Flat: gave an array of shape \(4,\); give \(episode, agent\)"),
        ("Endless", "reward own_term:Endless: gave a number that is not finite"),
    ],
)
def test_what_a_term_gives_is_checked(folder: Path, term: str, words: str) -> None:
    env = gymnasium.make("mjforage/Foraging-v0", **options(reward={f"own_term:{term}": 1.0}))
    env.reset(seed=1)
    with pytest.raises(UserError, match=words):
        env.step(np.full(4, 4))


def test_a_models_encoder_is_part_of_the_run(folder: Path) -> None:
    setup = Setup.of(load_scenario("comb-port", SHORT))
    evaluate(setup, ["own_model:Late"], folder / "run", episodes=1)
    code = json.loads(_text(folder / "run"))["code"]
    assert {"own_model", "own_encoder"} <= set(code) and "own_term" not in code
    forget()
    (folder / "own_encoder.py").write_text(ENCODER + "\n# edited\n")
    with pytest.raises(
        UserError, match=r"another run: code.own_encoder is .* here; give resume=.accept-code"
    ):
        evaluate(setup, ["own_model:Late"], folder / "run", episodes=1)


def _text(run: Path) -> str:
    return (run / "run.json").read_text()


def trained(folder: Path, updates: int = 1, **options: Any) -> Any:
    scenario = load_scenario("comb-port", ("horizon=6",))
    settings = changed(Hyperparameters(), TINY)
    return train(scenario, settings, folder, updates=updates, device="cpu", **options)


def test_training_takes_them_and_minds_their_source(folder: Path) -> None:
    trained(folder / "run")
    info = json.loads((folder / "run" / "training.json").read_text())
    assert info["hyperparameters"]["observation"] == CLOCK
    assert info["hyperparameters"]["reward"][SOUTH] == 0.5
    assert {"own_encoder", "own_term"} <= set(info["code"])
    words = {"own_encoder": ENCODER, "own_term": TERM}
    for name, source in words.items():
        forget()
        (folder / f"{name}.py").write_text(source + "\n# edited\n")
        with pytest.raises(
            UserError, match=rf"another training: code.{name} is .* here; give resume=.accept"
        ):
            trained(folder / "run", 2)
        (folder / f"{name}.py").write_text(source)
    forget()
    (folder / "own_model.py").write_text("")  # decides nothing
    trained(folder / "run", 2)


def test_weights_name_their_encoder(folder: Path) -> None:
    trained(folder / "run")
    weights = folder / "mine.safetensors"
    weights.write_bytes((folder / "run" / "weights.safetensors").read_bytes())
    assert read_header(weights).encoding == CLOCK
    setup = Setup.of(load_scenario("comb-port", SHORT))
    evaluate(setup, ["mine"], folder / "play", episodes=1)
    assert "own_encoder" in json.loads(_text(folder / "play"))["code"]
    forget()
    (folder / "own_encoder.py").rename(folder / "elsewhere.txt")
    with pytest.raises(UserError, match=r"mine.safetensors: observation own_encoder:.*no module"):
        read_header(weights)


def test_installed_packages_bring_them(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    facts = folder / "site" / "reef-1.2.dist-info"
    facts.mkdir(parents=True)
    (facts / "METADATA").write_text("Metadata-Version: 2.1\nName: reef\nVersion: 1.2\n")
    (facts / "entry_points.txt").write_text(
        "[mjforage.observations]\nclock = own_encoder:Clock\n"
        "[mjforage.rewards]\nsouth = own_term:Southing\n"
    )
    monkeypatch.syspath_prepend(folder / "site")
    for table in (ENCODERS, REWARDS):
        monkeypatch.delitem(table.__dict__, "_entries", raising=False)
    view = mjforage.parallel_env(set=SHORT, observation="clock(bins=2)", reward={"south": 1.0})
    seen, infos = view.reset(seed=1)
    assert seen["scouts_0"]["clock"].shape == (2,) and "reward/south" in infos["scouts_0"]
    for table in (ENCODERS, REWARDS):
        del table.__dict__["_entries"]
