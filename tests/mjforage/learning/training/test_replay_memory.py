import numpy as np
import pytest
import torch

from mjforage.graph_planner.encodings import Shapes
from mjforage.learning.training.replay_memory import FINAL, LAST, NOTHING, PLAYED, ReplayMemory

SHAPES: Shapes = {"x": (1,)}
GAMMA = 0.5


def fill(
    replay: ReplayMemory, lengths: tuple[int, int], ended: tuple[bool, bool], base: int = 0
) -> None:
    """Two streams of decisions; pictures count up, the reward of decision t is 10^stream t."""
    for t in range(max(lengths) + 1):
        kind = [PLAYED if t < n else FINAL if t == n else NOTHING for n in lengths]
        levels = {"x": np.array([[base + t], [base + 100 + t]], np.uint8)}
        replay.open(levels, np.ones((2, 9), np.bool_), np.array(kind, np.uint8))
        if t == max(lengths):
            break
        over = np.array([ended[i] and t == lengths[i] - 1 for i in range(2)])
        rewards = np.array([1.0 * t, 10.0 * t])
        replay.close(np.array([t % 9] * 2), np.zeros((2, 9), np.bool_), rewards, over)
    replay.finish()


def drawn(replay: ReplayMemory) -> dict[int, tuple[float, float, int]]:
    """Picture -> (return, discount, following picture) of everything that can be drawn."""
    found = {}
    for seed in range(30):
        batch = replay.draw(16, 1.0, np.random.default_rng(seed))
        for i in range(16):
            found[int(batch.levels["x"][i, 0])] = (
                float(batch.rewards[i]),
                float(batch.discount[i]),
                int(batch.following["x"][i, 0]),
            )
    return found


def test_returns_are_cut_at_the_end_and_bootstrap_past_the_horizon() -> None:
    replay = ReplayMemory(SHAPES, 2, 100, 2, GAMMA)
    fill(replay, (4, 3), (True, False))  # the first comes to its end, the second to the horizon
    assert drawn(replay) == {
        0: (0 + GAMMA * 1, GAMMA**2, 2),
        1: (1 + GAMMA * 2, GAMMA**2, 3),
        2: (2 + GAMMA * 3, 0.0, 4),
        3: (3.0, 0.0, 4),
        100: (0 + GAMMA * 10, GAMMA**2, 102),
        101: (10 + GAMMA * 20, GAMMA**2, 103),
        102: (20.0, GAMMA, 103),
    }
    assert len(replay) == 7


def test_old_rows_give_way_and_rows_without_a_successor_wait() -> None:
    replay = ReplayMemory(SHAPES, 2, 12, 1, GAMMA)  # six blocks
    fill(replay, (3, 3), (True, True))
    fill(replay, (3, 3), (True, True), base=10)
    found = drawn(replay)
    assert set(found) == {2, 102, 10, 11, 12, 110, 111, 112}  # two old blocks are gone
    assert found[2][1] == 0.0
    replay.open(
        {"x": np.array([[50], [150]], np.uint8)},
        np.ones((2, 9), np.bool_),
        np.full(2, PLAYED, np.uint8),
    )
    replay.close(
        np.zeros(2, np.int64), np.zeros((2, 9), np.bool_), np.zeros(2), np.zeros(2, np.bool_)
    )
    assert set(drawn(replay)) == {10, 11, 12, 110, 111, 112}


def test_rows_are_drawn_by_priority_and_weighted_back() -> None:
    replay = ReplayMemory(SHAPES, 2, 100, 1, GAMMA)
    fill(replay, (2, 2), (True, True))
    rows = np.arange(4)
    replay.reprioritise(rows, np.array([8.0, 1.0, 1.0, 0.0], np.float32) - 0.01, 1.0)
    counts, total = np.zeros(4), 0
    for seed in range(200):
        batch = replay.draw(10, 1.0, np.random.default_rng(seed))
        counts += np.bincount(batch.rows, minlength=4)
        total += 10
        share = replay.tree[replay.tree.size // 2 + batch.rows] / replay.tree[1]
        np.testing.assert_allclose(batch.weights * share, (batch.weights * share)[0], rtol=1e-6)
    np.testing.assert_allclose(counts / total, [0.8, 0.1, 0.1, 0.001], atol=0.01)


def test_an_arrays_round_trip_is_the_same_replay() -> None:
    replay, twin = ReplayMemory(SHAPES, 2, 20, 2, GAMMA), ReplayMemory(SHAPES, 2, 20, 2, GAMMA)
    for base in (0, 20, 40):
        fill(replay, (5, 4), (True, False), base)
    twin.restore({name: array.copy() for name, array in replay.arrays().items()})
    for one in (replay, twin):
        fill(one, (3, 3), (True, True), 60)
    first, second = (one.draw(32, 0.5, np.random.default_rng(1)) for one in (replay, twin))
    for name in ("rows", "moves", "rewards", "discount", "following_legal", "weights"):
        assert getattr(first, name).tobytes() == getattr(second, name).tobytes()
    assert torch.equal(first.levels["x"], second.levels["x"])
    assert torch.equal(first.following["x"], second.following["x"])
    assert replay.kind.max() == FINAL > LAST


def test_an_empty_replay_counts_nothing() -> None:
    assert len(ReplayMemory(SHAPES, 2, 10, 1, GAMMA)) == 0
    assert ReplayMemory(SHAPES, 4, 0, 3, GAMMA).blocks == 8
    assert pytest.approx(1.0) == ReplayMemory(SHAPES, 1, 10, 1, GAMMA).most
