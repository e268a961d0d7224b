"""Prioritised replay memory (Schaul et al. 2016) of streams of decisions side by side.

A stream is one agent of a team in one sub-environment.

Blocks are written in turn: block b has one row for every stream, so the row after a row of a
stream is `streams` places on, and following pictures need no memory of their own. A row can be
drawn when its n-step successor has been written.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from mjforage.base.compiled import kernel
from mjforage.graph_planner.encodings import Shapes

NOTHING, PLAYED, LAST, FINAL = 0, 1, 2, 3
"""Kinds of rows: empty; a decision; the decision that ends the task, with nothing after it to hope
for; the picture after a stream's last decision."""
LEAST = 1e-2  # added to errors, so that no decision is forgotten


class Batch(NamedTuple):
    """Rows drawn for one update."""

    rows: NDArray[np.int64]
    levels: dict[str, Tensor]  # (row, ...) uint8, where the memory is
    moves: NDArray[np.int64]
    demonstrated: NDArray[np.bool_]  # (row, 9) the teacher's moves; none where it was not asked
    rewards: NDArray[np.float32]  # discounted sum until the successor
    discount: NDArray[np.float32]  # of the successor's value; 0 where there is none
    following: dict[str, Tensor]
    following_legal: NDArray[np.bool_]  # (row, 9)
    weights: NDArray[np.float32]  # importance


@kernel
def _put(tree: NDArray[np.float64], rows: NDArray[np.int64], values: NDArray[np.float64]) -> None:
    """Set leaves of a tree of sums; leaf i of a tree of size 2 n is at n + i."""
    leaves = tree.size // 2
    for k in range(rows.size):
        i = leaves + rows[k]
        tree[i] = values[k]
        while i > 1:
            i //= 2
            tree[i] = tree[2 * i] + tree[2 * i + 1]


@kernel
def _find(tree: NDArray[np.float64], marks: NDArray[np.float64]) -> NDArray[np.int64]:
    """Leaf in which each mark, between 0 and the sum of all, falls."""
    leaves = tree.size // 2
    found = np.empty(marks.size, np.int64)
    for k in range(marks.size):
        i, mark = 1, marks[k]
        while i < leaves:
            i *= 2
            if mark >= tree[i] and tree[i + 1] > 0.0:
                mark -= tree[i]
                i += 1
        found[k] = i - leaves
    return found


@kernel
def _look_ahead(
    rows: NDArray[np.int64],
    kind: NDArray[np.uint8],
    rewards: NDArray[np.float32],
    streams: int,
    n_step: int,
    gamma: float,
    sums: NDArray[np.float32],
    discount: NDArray[np.float32],
    successor: NDArray[np.int64],
) -> None:
    """n-step returns, cut short where a stream ends."""
    for k in range(rows.size):
        row, total, factor = rows[k], 0.0, 1.0
        for _ in range(n_step):
            total += factor * rewards[row]
            factor *= gamma
            ended = kind[row] == LAST
            row = (row + streams) % kind.size
            if ended:
                factor = 0.0
            if ended or kind[row] == FINAL:
                break
        sums[k], discount[k], successor[k] = total, factor, row


def blocks_of(streams: int, capacity: int, n_step: int) -> int:
    """Blocks of a memory: as many as fit, and enough for two returns."""
    return max(capacity // max(streams, 1), 2 * n_step + 2)


def memory_bytes(shapes: Shapes, streams: int, capacity: int, n_step: int) -> int:
    """Memory that a `ReplayMemory` takes once it is full [byte]; parameters as there."""
    rows = blocks_of(streams, capacity, n_step) * streams
    row = sum(int(np.prod(shape)) for shape in shapes.values()) + 9 + 1 + 9 + 4 + 1
    return rows * row + 8 * _tree_size(rows)


def _tree_size(rows: int) -> int:
    return 2 << max(rows - 1, 1).bit_length()


class ReplayMemory:
    """Memory of one team. All arrays but the tree of priorities are (row, ...).

    Pictures are tensors on a device of torch, which they need not leave.
    """

    def __init__(
        self,
        shapes: Shapes,
        streams: int,
        capacity: int,
        n_step: int,
        gamma: float,
        device: str = "cpu",
    ) -> None:
        self.streams, self.n_step, self.gamma = streams, n_step, gamma
        self.blocks = blocks_of(streams, capacity, n_step)
        rows = self.blocks * streams
        self.levels = {
            name: torch.zeros((rows, *shape), dtype=torch.uint8, device=device)
            for name, shape in shapes.items()
        }
        self.legal = np.zeros((rows, 9), np.bool_)
        self.moves = np.zeros(rows, np.uint8)
        self.demonstrated = np.zeros((rows, 9), np.bool_)
        self.rewards = np.zeros(rows, np.float32)
        self.kind = np.zeros(rows, np.uint8)
        self.tree = np.zeros(_tree_size(rows))
        self.written, self.ready, self.most = 0, 0, 1.0  # blocks; blocks; largest priority

    def __len__(self) -> int:
        return int((self.tree[self.tree.size // 2 :] > 0).sum())

    def warm(self, rows: int) -> bool:
        """True if so many rows can be drawn, or as many as there is room for."""
        return len(self) >= max(1, rows) or self.written > self.blocks

    def _block(self, number: int) -> slice:
        first = number % self.blocks * self.streams
        return slice(first, first + self.streams)

    def open(
        self,
        levels: Mapping[str, NDArray[np.uint8] | Tensor],
        legal: NDArray[np.bool_],
        kind: NDArray[np.uint8],
    ) -> None:
        """Begin a block with the observations: pictures (stream, ...), legal (stream, 9), kind."""
        block = self._block(self.written)
        rows = np.arange(block.start, block.stop)
        _put(self.tree, rows, np.zeros(self.streams))
        for name, level in levels.items():
            self.levels[name][block] = torch.as_tensor(level)
        self.legal[block], self.kind[block] = legal, kind
        self.demonstrated[block], self.rewards[block] = False, 0.0
        self.written += 1
        if self.written - self.ready > self.n_step:
            self._release()

    def close(
        self,
        moves: NDArray[np.int64],
        demonstrated: NDArray[np.bool_],
        rewards: NDArray[np.float64],
        over: NDArray[np.bool_],
    ) -> None:
        """Complete the block with rewards and ends.

        Parameters
        ----------
        moves : (stream,) taken
        demonstrated : (stream, 9) the teacher's
        rewards : (stream,)
        over : (stream,) where the task came to its end
        """
        block = self._block(self.written - 1)
        self.moves[block], self.demonstrated[block], self.rewards[block] = (
            moves,
            demonstrated,
            rewards,
        )
        self.kind[block][over] = LAST

    def finish(self) -> None:
        """End of all streams: the remaining decisions can be drawn, too."""
        while self.ready < self.written:
            self._release()

    def _release(self) -> None:
        block = self._block(self.ready)
        rows = np.arange(block.start, block.stop)
        playable = (self.kind[block] == PLAYED) | (self.kind[block] == LAST)
        _put(self.tree, rows, np.where(playable, self.most, 0.0))
        self.ready += 1

    def draw(self, size: int, correction: float, random: np.random.Generator) -> Batch:
        """Draw rows in proportion to their priorities, one per equal share of the sum."""
        total = self.tree[1]
        marks = (np.arange(size) + random.random(size)) / size * total
        rows = _find(self.tree, marks)
        share = self.tree[self.tree.size // 2 + rows] / total
        weights = (share * len(self)) ** -correction
        sums, discount = np.empty(size, np.float32), np.empty(size, np.float32)
        successor = np.empty(size, np.int64)
        _look_ahead(
            rows,
            self.kind,
            self.rewards,
            self.streams,
            self.n_step,
            self.gamma,
            sums,
            discount,
            successor,
        )
        drawn, later = torch.from_numpy(rows), torch.from_numpy(successor)
        return Batch(
            rows=rows,
            levels={name: level[drawn] for name, level in self.levels.items()},
            moves=self.moves[rows].astype(np.int64),
            demonstrated=self.demonstrated[rows],
            rewards=sums,
            discount=discount,
            following={name: level[later] for name, level in self.levels.items()},
            following_legal=self.legal[successor],
            weights=(weights / weights.max()).astype(np.float32),
        )

    def reprioritise(
        self, rows: NDArray[np.int64], errors: NDArray[np.float32], power: float
    ) -> None:
        """Priorities of drawn rows from the size of their errors."""
        values = (np.abs(errors.astype(np.float64)) + LEAST) ** power
        self.most = max(self.most, float(values.max()))
        _put(self.tree, rows, values)

    def arrays(self) -> dict[str, NDArray[np.generic]]:
        """All memory, for a checkpoint; `restore` takes it back."""
        rows = min(self.written, self.blocks) * self.streams
        leaves = self.tree.size // 2
        own = {"legal", "moves", "demonstrated", "rewards", "kind"}
        return {
            **{f"levels.{name}": level[:rows].cpu().numpy() for name, level in self.levels.items()},
            **{name: getattr(self, name)[:rows] for name in sorted(own)},
            "priorities": self.tree[leaves : leaves + rows],
            "counters": np.array([self.written, self.ready, self.most]),
        }

    def restore(self, arrays: dict[str, NDArray[np.generic]]) -> None:
        """Restore the state that `arrays` gave.

        Raises `ValueError` if they are not of such a memory, or hold what none can.
        """
        counters = np.asarray(arrays.get("counters", ()), np.float64)
        if counters.shape != (3,) or not np.isfinite(counters).all():
            raise ValueError("counters of a replay are three numbers")
        written, ready, self.most = int(counters[0]), int(counters[1]), float(counters[2])
        if not 0 <= ready <= written <= 2**53 or self.most <= 0.0:
            raise ValueError(f"counters of a replay are {counters.tolist()}")
        self.written, self.ready = written, ready
        for name, mine in self.arrays().items():
            values = arrays.get(name, np.empty(0))
            if values.shape != mine.shape or values.dtype != mine.dtype:
                raise ValueError(f"{name} of a replay is {values.dtype} {values.shape}")
            if name == "priorities":
                self._take_priorities(np.asarray(values, np.float64))
            elif name.startswith("levels."):
                part = self.levels[name.removeprefix("levels.")]
                part[: len(values)] = torch.tensor(values)
            elif name != "counters":
                mine[...] = values
        if len(arrays) != len(self.arrays()) or self.moves.max() > 8:
            raise ValueError("a replay of other arrays, or of moves that are none")

    def _take_priorities(self, values: NDArray[np.float64]) -> None:
        if not (np.isfinite(values) & (values >= 0.0)).all():
            raise ValueError("priorities of a replay are below 0 or not finite")
        _put(self.tree, np.arange(values.size), values)
