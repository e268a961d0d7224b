"""Training on families of generated harbours: whose turn it is, what is kept, resuming, errors."""

from dataclasses import replace

import pytest

from mjforage.base.errors import UserError
from mjforage.learning.training.trainer import Trainer
from tests.mjforage.learning.training.tiny_runs import comb_port, on, small


def test_each_turn_takes_the_next_harbour() -> None:
    trainer = Trainer([comb_port(), on("harbours:5-7")], small(), seed=3)
    names = []
    for _ in range(10):
        trainer.play_round()
        (core,) = trainer.round.cores
        names.append(core.setup.grid.name)
    assert names[::2] == ["comb_port"] * 5
    kinds = [name.split(":")[1:3] for name in names[1::2]]
    assert kinds == [
        ["combs", "5"],
        ["basins", "6"],
        ["channels", "7"],
        ["combs", "5"],
        *kinds[1:2],
    ]
    notes = [note["map"] for task in trainer.tasks for note in task.notes]
    assert len(set(notes)) == len(notes) == 4


def test_values_are_drawn_on_harbours_too() -> None:
    linked = replace(on("harbours:5-6"), link=replace(comb_port().link, model="disk"))
    home = comb_port("link.model=disk")
    trainer = Trainer([home, linked], small(**{"vary.link.range_m": [16, 1e6]}), seed=3)
    trainer.play_round()
    trainer.play_round()
    assert {core.setup.grid.name.split(":")[1] for core in trainer.round.cores} == {"combs"}
    assert {core.setup.scenario.link.range_m for core in trainer.round.cores} <= {16, 1e6}


@pytest.mark.parametrize(
    ("first", "also", "words"),
    [
        ("harbours:0-3", "comb_port", "several maps, .* such as harbour:combs:0"),
        ("comb_port", "harbours:3-0", "expected harbours:FIRST-LAST"),
    ],
)
def test_a_family_that_cannot_be_is_refused(first: str, also: str, words: str) -> None:
    with pytest.raises(UserError, match=words):
        Trainer([on(first), on(also)], small())


def test_arrays_of_the_maps_size_are_refused_at_once() -> None:
    with pytest.raises(UserError, match=r"fleets or arrays .* differ; .* egocentric"):
        Trainer([comb_port(), on("harbours:0-1")], small(observation="paper"))
