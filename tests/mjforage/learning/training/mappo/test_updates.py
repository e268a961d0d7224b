"""Updates of multi-agent PPO: draws, advantages, shared actors, the warm start."""

import math

import numpy as np
import pytest
import torch

from mjforage.graph_planner.encodings import Shapes
from mjforage.graph_planner.networks.q_network import MoveNetwork
from mjforage.learning.training.mappo.critic import Critic
from mjforage.learning.training.mappo.critic_features import CRITIC_FEATURES
from mjforage.learning.training.mappo.hyperparameters import MappoHyperparameters
from mjforage.learning.training.mappo.rollout import Decisions, Rollout
from mjforage.learning.training.mappo.trainer import drawn
from mjforage.learning.training.mappo.updates import Actors, Updates, advantages, lacking

SHAPES: Shapes = {"x": (3,), "moves": (9, 2)}
TEAMS = {"scout": np.array([0, 2]), "forager": np.array([1])}
AGENTS = 3


def actors(seed: int = 0) -> Actors:
    torch.manual_seed(seed)
    return Actors({team: MoveNetwork(SHAPES) for team in TEAMS}, TEAMS)


def levels(rows: int, seed: int = 0) -> dict[str, np.ndarray]:
    random = np.random.default_rng(seed)
    own = {n: random.integers(0, 256, (rows, AGENTS, *s), np.uint8) for n, s in SHAPES.items()}
    return own | {
        n: random.integers(0, 256, (rows, *s), np.uint8) for n, s in CRITIC_FEATURES.items()
    }


def tensors(arrays: dict[str, np.ndarray]) -> dict[str, torch.Tensor]:
    return {name: torch.from_numpy(array) for name, array in arrays.items()}


def test_only_legal_moves_are_drawn_and_as_often_as_the_softmax_says() -> None:
    logits = np.tile(np.array([0.0, 1.0, 5.0, *[-1.0] * 6], np.float32), (20_000, 1, 1))
    legal = np.zeros(logits.shape, np.bool_)
    legal[..., :2] = True
    moves, chances = drawn(logits, legal, np.random.default_rng(0))
    assert set(moves.ravel()) == {0, 1}
    often = math.e / (1.0 + math.e)
    assert (moves == 1).mean() == pytest.approx(often, abs=0.01)
    expected = np.log(np.where(moves == 1, often, 1.0 - often))
    np.testing.assert_allclose(chances, expected, rtol=1e-5)


def test_a_team_shares_one_actor_and_an_agent_sees_its_own_alone() -> None:
    made, seen = actors(), tensors(levels(4))
    own = {name: seen[name] for name in SHAPES}
    logits = made(own)
    assert logits.shape == (4, AGENTS, 9)
    swapped = made({name: level[:, [2, 1, 0]] for name, level in own.items()})
    torch.testing.assert_close(swapped, logits[:, [2, 1, 0]])
    other_team = made({name: level[:, [1, 0, 2]] for name, level in own.items()})
    assert not torch.allclose(other_team[:, [1, 0]], logits[:, :2])
    changed = {name: level.clone() for name, level in own.items()}
    changed["x"][:, 0] = 255 - changed["x"][:, 0]
    again = made(changed)
    torch.testing.assert_close(again[:, 1:], logits[:, 1:])
    assert not torch.allclose(again[:, 0], logits[:, 0])


def test_the_critic_sees_all_agents_and_the_truth_whatever_the_fleet() -> None:
    torch.manual_seed(0)
    critic = Critic(SHAPES, list(TEAMS.values()))
    seen = tensors(levels(2))
    values = critic(seen)
    assert values.shape == (2, AGENTS, 1)
    for name in ("x", *CRITIC_FEATURES):
        changed = dict(seen)
        changed[name] = seen[name].clone()
        changed[name].view(2, -1)[:, 0] = 255 - changed[name].view(2, -1)[:, 0]
        assert (critic(changed) != values).any(dim=2).all(), name
    alone = Critic(SHAPES, [np.array([], np.int64), np.arange(AGENTS)])
    assert torch.isfinite(alone(seen)).all()


def played() -> Decisions:
    """Two episodes of one agent: the first of three steps ends at the horizon, the other is over
    after one, with no item left.
    """
    rollout, nothing = Rollout(), np.zeros((2, 1, 9), np.bool_)

    def add(envs: list[int], rewards: list[float], values: list[float], over: list[bool]) -> None:
        rows, column = np.array(envs), (len(envs), 1)
        none = nothing[: rows.size]
        rollout.add(
            rows,
            {"x": torch.zeros((2, 1, 3), dtype=torch.uint8)},
            none,
            none,
            np.zeros(column, np.int64),
            np.zeros(column, np.float32),
            np.array(rewards, np.float32).reshape(column),
            np.array(values, np.float32).reshape(column),
            np.array(over),
        )

    add([0, 1], [1.0, 5.0], [0.5, 2.0], [False, True])
    add([0], [0.0], [1.0], [False])
    add([0], [2.0], [3.0], [False])
    return rollout.finished(np.array([[4.0], [100.0]], np.float32))


def test_advantages_are_those_computed_by_hand() -> None:
    """Schulman et al. (2016), eq. 16: A_t = delta_t + gamma lambda A_t+1."""
    gamma, gae = 0.9, 0.5
    found, target = advantages(played(), gamma, gae)
    third = 2.0 + 0.9 * 4.0 - 3.0  # the horizon: the value of what came next counts
    second = (0.0 + 0.9 * 3.0 - 1.0) + 0.45 * third
    first = (1.0 + 0.9 * 1.0 - 0.5) + 0.45 * second
    other = 5.0 - 2.0  # no item left: nothing comes next
    expected = torch.tensor([first, other, second, third])
    torch.testing.assert_close(found[:, 0, 0], expected)
    torch.testing.assert_close(target[:, 0, 0], expected + torch.tensor([0.5, 2.0, 1.0, 3.0]))


def test_shown_moves_are_asked_for_among_the_legal_ones() -> None:
    logits = torch.tensor([[[0.0, 1.0, 2.0, *[9.0] * 6]] * 2])
    legal = torch.tensor([True] * 3 + [False] * 6).expand(1, 2, 9)
    demonstrated = torch.zeros(1, 2, 9, dtype=torch.bool)
    demonstrated[0, 0, :2] = True  # of the other agent nothing is demonstrated
    total = 1.0 + math.e + math.e**2
    assert float(lacking(logits, legal, demonstrated)) == pytest.approx(
        -np.log((1.0 + math.e) / total)
    )


def bandit(rows: int, seed: int, made: Updates) -> Decisions:
    """Episodes of one step that rewards moves with a large first feature; 7 is never legal."""
    random, seen = np.random.default_rng(seed), levels(rows, seed)
    legal = np.ones((rows, AGENTS, 9), np.bool_)
    legal[..., 7] = False
    with torch.no_grad():
        logits = made.actors({n: torch.from_numpy(seen[n]) for n in SHAPES}).numpy()
        values = made.real(tensors(seen)).numpy()[..., 0]
    moves, chances = drawn(logits, legal, random)
    ends = np.ones(rows, np.bool_)
    zeros = np.zeros(moves.shape, np.float32)
    demonstrated = legal & (seen["moves"][..., 0] > 160)
    rewards = np.take_along_axis(demonstrated, moves[..., None], axis=-1)[..., 0].astype(np.float32)
    return Decisions(
        *(tensors(seen), legal, demonstrated, moves, chances, rewards, values),
        *(zeros, ends, ends, np.zeros(rows, np.int64), np.arange(rows)),
    )


@pytest.mark.parametrize("taught", [False, True])
def test_it_learns_which_move_is_rewarded_or_shown(taught: bool) -> None:
    torch.manual_seed(0)
    settings = MappoHyperparameters(batch=64, learning_rate=3e-3)
    critic = Critic(SHAPES, list(TEAMS.values()))
    made = Updates(actors(), critic, list(SHAPES), settings)
    random = np.random.default_rng(0)
    wins = []
    for i in range(12):
        found = bandit(128, i, made)
        wins.append(float(found.rewards.mean()))
        facts = made.learn(found, random, taught)
    assert len(facts) == 4 * 2 and made.updates == 12 * 8
    assert wins[0] < 0.5 and wins[-1] > 0.75
    assert ("loss_taught" in facts[0]) is taught and ("loss_objective" in facts[0]) is not taught
    assert facts[-1]["loss_critic"] < 1.0


def test_rate_and_entropy_fall_in_straight_lines() -> None:
    settings = MappoHyperparameters(
        learning_rate=1e-3, rate_updates=10, entropy_from=0.1, entropy_to=0.0, entropy_updates=20
    )
    made = Updates(actors(), Critic(SHAPES, list(TEAMS.values())), list(SHAPES), settings)
    for updates, rate, entropy in ((0, 1e-3, 0.1), (5, 5.5e-4, 0.075), (30, 1e-4, 0.0)):
        made.updates = updates
        made._schedule()
        assert made.optimiser.param_groups[0]["lr"] == pytest.approx(rate)
        assert float(made.loss.entropy_coeff) == pytest.approx(entropy)
