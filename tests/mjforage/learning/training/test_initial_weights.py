"""Trainings that begin with existing weights: what they begin with, what is refused."""

import shutil
from pathlib import Path

import numpy as np
import polars as pl
import pytest
import torch

from mjforage.base.errors import UserError
from mjforage.graph_planner.networks.weights import load_networks, shipped_weights
from mjforage.graph_planner.policies import create_policy
from mjforage.learning.training.algorithm import save_weights
from mjforage.learning.training.evaluation import HELD_OUT
from mjforage.learning.training.hyperparameters import Hyperparameters
from mjforage.learning.training.run import train
from mjforage.learning.training.trainer import Trainer
from mjforage.mission.mission import Mission
from mjforage.mission.scoring import METRICS, Scorer
from mjforage.mission.setup import Setup
from tests.mjforage.learning.training.tiny_runs import comb_port, small


def settings(**changes: object) -> Hyperparameters:
    return small(**{"initial": "ddqn", **changes})


def begun(**changes: object) -> Trainer:
    trainer = Trainer([comb_port()], settings(**changes))
    trainer.begin()
    return trainer


def test_all_networks_begin_with_the_weights_and_optimisers_anew() -> None:
    trainer = begun()
    shipped = load_networks(shipped_weights("ddqn"), Setup.of(comb_port()).task)
    for team, learner in trainer.learners.items():
        parts = [part for part in vars(learner).values() if isinstance(part, torch.nn.Module)]
        assert len(parts) >= 2
        for part in parts:
            for name, value in shipped[team].state_dict().items():
                assert torch.equal(part.state_dict()[name], value), f"{team}.{name}"
        assert all(value.requires_grad for value in learner.online.parameters())
        assert not learner.optimiser.state_dict()["state"]
        assert learner.updates == 0


def test_the_first_evaluation_is_that_of_the_weights(tmp_path: Path) -> None:
    """Before any update: of the policy that plays them, the best until a better one is found."""
    train(comb_port(), settings(), tmp_path, updates=1)
    first = pl.read_parquet(tmp_path / "evaluations.parquet").row(0, named=True)
    assert first["updates"] == first["rounds"] == 0
    mission = Mission(Setup.of(comb_port()))
    mission.reset(HELD_OUT, np.arange(5))
    scorer = Scorer(mission, [METRICS.find(key) for key in ("pta_d", "pta_c")])
    mission.run(create_policy("ddqn"), (scorer,))
    for name, values in scorer.scores().scalars.items():
        assert first[name] == pytest.approx(values.mean()), name
    assert first["pta_d"] > 0.0
    assert (tmp_path / "best.safetensors").is_file()


def test_weights_are_a_policys_or_a_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "deep").mkdir()
    for copy in ("mine.safetensors", "deep/mine.safetensors"):
        shutil.copy(shipped_weights("ddqn"), copy)
    saved, path = [], tmp_path / "out"
    for initial in ("ddqn", "mine", "mine.safetensors", "deep/mine.safetensors"):
        save_weights(begun(initial=initial), path)
        saved.append(path.read_bytes())
    assert len(set(saved)) == 1
    save_weights(begun(initial="ddqn-link"), path)
    assert path.read_bytes() != saved[0]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"initial": "greedy"}, "initial weights greedy: is a policy that plays none; give one"),
        ({"initial": "ddqm"}, "policy ddqm: unknown; did you mean ddqn"),
        ({"initial": "none.safetensors"}, "weights none.safetensors: cannot be read"),
        ({"observation": "paper"}, "initial weights ddqn: are of the egocentric observation, but"),
        ({"initial": "bad.safetensors"}, "weights bad.safetensors: not a safetensors file"),
        ({"initial": "small.safetensors"}, "weights small.safetensors: none for a scout"),
    ],
)
def test_weights_that_do_not_fit_are_refused(
    changes: dict[str, object], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("bad.safetensors").write_bytes(b"none")
    alone = comb_port("team.scouts.count=0", "map.starts=[]")
    save_weights(Trainer([alone], settings(initial="")), Path("small.safetensors"))
    with pytest.raises(UserError, match=words):
        train(comb_port(), settings(**changes), tmp_path / "run", updates=1)
    assert not (tmp_path / "run").exists()
