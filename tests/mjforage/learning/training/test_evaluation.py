"""Evaluations on other scenarios than a run's first: who shares the episodes, resuming, errors."""

import json
from functools import partial
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from mjforage.base.errors import UserError
from mjforage.graph_planner.policies import create_policy
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.training.evaluation import HELD_OUT, Evaluation
from mjforage.learning.training.run import train
from mjforage.learning.training.trainer import Trainer
from mjforage.mission.scoring import METRICS, Scorer
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from tests.mjforage.learning.training.tiny_runs import comb_port, on, placed, small


@pytest.mark.parametrize("world", ["graph", "hulls"])
def test_maps_share_the_episodes(world: str) -> None:
    """Episode i is on map i modulo their number: 3 of 5 on the first, 2 on the second."""
    first = comb_port("period_s=3")  # in which hulls do not get far
    pair = [first, placed(first, "harbour:combs:901")]
    options = partial(EnvironmentOptions, world=world)
    found = Evaluation(pair, options, 5).scores(create_policy("greedy"))
    values: list[float] = []
    variances = []
    for each, numbers in zip(pair, ([0, 2, 4], [1, 3]), strict=True):
        mission = create_mission(Setup.of(each), world)
        mission.reset(HELD_OUT, np.array(numbers))
        scorer = Scorer(mission, [METRICS.find("pta_d")])
        mission.run(create_policy("greedy"), (scorer,))
        ours = scorer.scores().scalars["pta_d"]
        values += ours.tolist()
        variances.append(len(ours) * np.var(ours, ddof=1))
    assert len(set(values)) > 1
    assert found["pta_d"] == pytest.approx(np.mean(values))
    assert found["pta_d_sem"] == pytest.approx(np.sqrt(sum(variances)) / 5)
    assert found["rank"] == pytest.approx(
        found["nt50"] + found["nt90"] + (100 - found["pta_c"]) / 20
    )


def test_a_familys_harbours_are_maps_of_their_own() -> None:
    one = Evaluation([on("harbours:900-901")], EnvironmentOptions, 5)
    other = Evaluation([on("harbour:combs:900"), on("harbour:basins:901")], EnvironmentOptions, 5)
    greedy = create_policy("greedy")
    assert one.scores(greedy) == other.scores(greedy)


@pytest.mark.every_capability
def test_a_run_is_judged_on_them_and_goes_on_only_with_them(tmp_path: Path) -> None:
    first, judged = comb_port(), [on("harbours:900-901")]
    train(first, small(), tmp_path, evaluate=judged, seed=3, updates=10)
    (written,) = json.loads((tmp_path / "training.json").read_text())["evaluate"]
    assert written["map"]["file"] == "harbours:900-901"
    trainer = train(first, small(), tmp_path, evaluate=judged, seed=3, updates=20)
    last = pl.read_parquet(tmp_path / "evaluations.parquet").row(-1, named=True)
    assert last["updates"] == trainer.progress.updates >= 20
    again = trainer.evaluate()
    assert again["pta_d"] == last["pta_d"]
    at_home = Trainer([first], small(), seed=3)
    at_home.restore(trainer.tensors())
    assert at_home.evaluate()["pta_d"] != last["pta_d"]
    with pytest.raises(UserError, match=r"evaluate differs; maps is "):
        train(first, small(), tmp_path, seed=3, updates=30)


@pytest.mark.parametrize(
    ("judged", "words"),
    [
        (
            "harbours:900-905",
            "6 maps for evaluate_episodes = 5; give fewer maps, or .* = 6 or more",
        ),
        ("harbours:3-0", "expected harbours:FIRST-LAST"),
        ("nowhere", "nowhere"),
    ],
)
def test_what_cannot_be_evaluated_is_refused_at_once(judged: str, words: str) -> None:
    trainer = Trainer([comb_port()], small())
    with pytest.raises(UserError, match=words):
        trainer.evaluate_on([on(judged)])
    assert trainer.evaluation.scenarios == (comb_port(),)


def test_other_fleets_and_arrays_are_refused() -> None:
    trainer = Trainer([comb_port()], small())
    with pytest.raises(UserError, match=r"fleets or arrays .* differ"):
        trainer.evaluate_on([comb_port("team.scouts.count=3")])
    by_map = Trainer([comb_port()], small(observation="paper"))
    with pytest.raises(UserError, match=r"fleets or arrays .* differ; give .* egocentric"):
        by_map.evaluate_on([on("harbour:combs:900")])


def test_every_map_has_its_own_scores_where_there_are_several() -> None:
    both = Evaluation([on("harbours:900-901")], EnvironmentOptions, 5)
    row = both.scores(create_policy("greedy"))
    combs, basins = (row[f"pta_d/comb-port:harbour:{name}"] for name in ("combs:900", "basins:901"))
    assert row["pta_d"] == pytest.approx((3 * combs + 2 * basins) / 5)
    alone = Evaluation([comb_port()], EnvironmentOptions, 5).scores(create_policy("greedy"))
    assert not any("/" in name for name in alone)
