"""The algorithm on problems whose values are known."""

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from mjforage.graph_planner.encodings import Shapes
from mjforage.learning.training.hyperparameters import Hyperparameters, changed
from mjforage.learning.training.learner import Learner, lead_lacking
from mjforage.learning.training.replay_memory import Batch
from mjforage.learning.training.trainer import Trainer
from mjforage.scenario.scenario_file import load_scenario

pytestmark = pytest.mark.every_capability

SHAPES: Shapes = {"x": (2,)}


def learner(seed: int = 0, **changes: object) -> Learner:
    plain = {"n_step": 1, "gamma": 0.5, "learning_rate": 1e-2}
    hyperparameters = changed(Hyperparameters(), plain | changes)
    return Learner(SHAPES, 1, hyperparameters, seed)


def batch(following: list[int], discount: float = 0.5, demonstrated: tuple[int, ...] = ()) -> Batch:
    """Legal moves after move 3, which earned 1."""
    after, teacher = np.zeros((2, 1, 9), np.bool_)
    after[0, following] = teacher[0, list(demonstrated)] = True
    return Batch(
        rows=np.zeros(1, np.int64),
        levels={"x": torch.tensor([[255, 0]], dtype=torch.uint8)},
        moves=np.array([3]),
        demonstrated=teacher,
        rewards=np.ones(1, np.float32),
        discount=np.array([discount], np.float32),
        following={"x": torch.tensor([[0, 255]], dtype=torch.uint8)},
        following_legal=after,
        weights=np.ones(1, np.float32),
    )


@pytest.mark.parametrize("legal", [[0], [4, 7], list(range(9))])
def test_the_goal_masks_both_argmaxes(legal: list[int]) -> None:
    """The online network chooses among the legal moves, the target values the choice."""
    one = learner()
    with torch.no_grad():
        for parameter in one.target.parameters():
            parameter.add_(0.1)
    b = batch(legal)
    online, target = one.online(b.following)[0].detach(), one.target(b.following)[0]
    best = max(legal, key=lambda move: float(online[move]))
    goal = 1.0 + 0.5 * float(target[best])
    value = float(one.online(b.levels).detach()[0, 3])
    _, errors = one.learn(b)
    assert errors[0] == pytest.approx(value - goal, abs=1e-5)


def test_nothing_is_hoped_for_after_the_end() -> None:
    one = learner()
    value = float(one.online({"x": torch.tensor([[255, 0]], dtype=torch.uint8)}).detach()[0, 3])
    _, errors = one.learn(batch([0], discount=0.0))
    assert errors[0] == pytest.approx(value - 1.0, abs=1e-5)


def test_the_target_follows_slowly() -> None:
    one = learner(target_rate=0.25)
    old = [p.clone() for p in one.target.parameters()]
    one.learn(batch([0]))
    for before, now, online in zip(
        old, one.target.parameters(), one.online.parameters(), strict=True
    ):
        torch.testing.assert_close(now, before + 0.25 * (online - before))


def test_a_shown_move_comes_to_lead_by_the_margin() -> None:
    one = learner(margin=0.5, margin_weight=1.0)
    for _ in range(150):
        one.learn(batch([0], discount=0.0, demonstrated=(6,)))
    values = one.values({"x": np.array([[255, 0]], np.uint8)})[0]
    others = np.delete(values, 6)
    assert values[6] - others.max() > 0.4
    assert values[3] == pytest.approx(1.0, abs=0.35)  # its reward pulls, too


def test_any_of_the_shown_moves_may_lead() -> None:
    values = torch.tensor([[0.0, 1.0, 2.0, 1.8], [0.0, 1.0, 2.0, 1.8]])
    both = torch.tensor([[False, False, True, True], [False, False, False, True]])
    found = lead_lacking(values, both, margin=0.5)
    torch.testing.assert_close(found, torch.tensor([0.0, 2.5 - 1.8]))
    nothing = lead_lacking(values, torch.zeros_like(both), margin=0.5)
    torch.testing.assert_close(nothing, torch.zeros(2))


@pytest.mark.parametrize("eta", [0.0, 1.0, 3.0])
def test_the_average_is_of_all_weights_the_later_ones_counting_more(eta: float) -> None:
    """Weights after update s of n: those of a sum unrolled, (eta + 1) / (s + eta) x the rest."""
    one, seen = learner(averaging=eta), []
    for _ in range(6):
        one.learn(batch([0, 3]))
        seen.append([p.detach().numpy().copy() for p in one.online.parameters()])
    s = np.arange(1, 7)
    share = (eta + 1.0) / (s + eta)
    kept = np.append(np.cumprod((1.0 - share)[:0:-1])[::-1], 1.0)
    weights = share * kept
    assert weights.sum() == pytest.approx(1.0)
    age = (weights * (6 - s)).sum()
    assert age == pytest.approx(5 / (eta + 2.0))
    for k, found in enumerate(one.average.parameters()):
        expected = sum(w * each[k] for w, each in zip(weights, seen, strict=True))
        np.testing.assert_allclose(found.numpy(), expected, rtol=1e-4, atol=1e-6)


def moved(one: Learner) -> list[NDArray[np.float32]]:
    """Change of the weights by an update."""
    before = [p.detach().numpy().copy() for p in one.online.parameters()]
    one.learn(batch([0, 3]))
    return [p.detach().numpy() - b for p, b in zip(one.online.parameters(), before, strict=True)]


def test_steps_become_smaller_as_the_rate_falls() -> None:
    """The first update is that of a constant rate; after rate_halves = 1 of them steps halve."""
    constant, falling = learner(), learner(rate_halves=1)
    for a, b in zip(moved(constant), moved(falling), strict=True):
        np.testing.assert_array_equal(a, b)
    for a, b in zip(moved(constant), moved(falling), strict=True):
        np.testing.assert_allclose(b, a / 2.0, rtol=1e-3, atol=1e-7)
    assert constant.rate == 1e-2
    assert falling.rate == 1e-2 / 4.0


def test_what_is_played_in_the_end_is_the_average() -> None:
    trainer = Trainer([load_scenario("published")], changed(Hyperparameters(), {}), seed=0)
    assert set(trainer.networks) == set(trainer.learners)
    for team, one in trainer.learners.items():
        assert trainer.networks[team] is one.average
