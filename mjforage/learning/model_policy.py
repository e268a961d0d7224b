"""Models trained elsewhere as policies: a class of a few lines, played in any world.

The encoding, the masks and the order of deciding are those of the environment that a model was
trained on, so that an episode of `evaluate` is, at graph level, the environment's to the bit.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.encodings import LegalMoves, create_encoder, encoder_class
from mjforage.graph_planner.encodings.masks import legal_of_agent
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.graph_planner.networks.inference import BLOCK, one_thread
from mjforage.learning.environments.spaces import MASK, Arrays, values
from mjforage.mission.moves import CHOSEN, OTHERWISE_STAY
from mjforage.mission.plain import Plain
from mjforage.mission.resolver import Corruption, Resolver
from mjforage.mission.task import Observation, Task

Rows = NDArray[np.int64]


class ModelPolicy:
    """Base of a policy that asks a model; a subclass gives `decide`, and may set the two names.

    Attributes
    ----------
    trained_on : the environment: mjforage/SharedPolicy-v0, mjforage/Foraging-v0 or parallel_env
    observation : reference to the encoder that it was made with, as `observation=` there
    task : map, fleet and rules, from `reset` on
    """

    trained_on: ClassVar[str] = "mjforage/SharedPolicy-v0"
    observation: str = "egocentric"

    def __init__(self, files: Sequence[str | Path] = ()) -> None:
        """Name the files that the model is read from: they are then part of what a run is.

        Raises `UserError` if one is missing.
        """
        self.files = tuple(Path(file) for file in files)
        for file in self.files:
            if not file.is_file():
                raise UserError(f"model {file}: there is no such file; train one, or name another")

    @property
    def parts(self) -> tuple[Callable[..., Any], ...]:
        """The encoder, whose source is part of a run's identity."""
        return (encoder_class(self.observation),)

    def decide(self, seen: Arrays, agents: Rows) -> NDArray[Any]:
        """Ask the model.

        Returns: moves (row,) as integers, or values (row, 9) of which the largest legal one counts;
        with an agent axis behind the row for mjforage/Foraging-v0. Rows must not depend on one
        another.

        Parameters
        ----------
        seen : observations of the environment, `action_mask` included, with a leading row axis
        agents : (row,) whose each is; for mjforage/Foraging-v0, where all agents are in a row, -1
        """
        raise NotImplementedError

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,).

        Raises `UserError` if `trained_on` or `observation` is not known.
        """
        if self.trained_on not in _VIEWS:
            raise UserError(
                f"{type(self).__name__}.trained_on = {self.trained_on!r}: unknown; choose "
                f"{', '.join(_VIEWS)}"
            )
        self.task = task
        self._encoder = create_encoder(self.observation, task)
        self._encoder.reset(keys.size)
        calm = Corruption(np.zeros(len(task.fleet)))
        self._resolver = Resolver(task.graph, task.fleet, task.rules, calm)
        self._claimed = np.zeros((keys.size, len(task.graph)), np.int64)
        self._round = 0
        self._plain = Plain(task, keys.size)
        self._preferences = np.zeros((keys.size, len(task.fleet), 9))

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9) for the moves that the model decides on."""
        observation = self._plain(observation)
        rows = np.flatnonzero(observation.active)
        levels = self._encoder.see(observation, rows)
        seen = {name: values(level[rows]) for name, level in levels.items()}
        self._preferences[..., :STAY], self._preferences[..., STAY] = 0.0, OTHERWISE_STAY
        if rows.size:
            _VIEWS[self.trained_on](self, observation, rows, seen)
        return self._preferences

    def _ask(self, seen: Arrays, agents: Rows) -> NDArray[np.int64]:
        """Moves (row, ...), asked for in blocks of one size, so that the batch changes no bit."""
        parts = []
        mask = seen[MASK].astype(np.bool_)
        for first in range(0, agents.size, BLOCK):
            real = np.arange(first, min(first + BLOCK, agents.size))
            block = np.concatenate((real, np.full(BLOCK - real.size, first)))
            with one_thread():
                said = np.asarray(
                    self.decide({name: part[block] for name, part in seen.items()}, agents[block])
                )
            parts.append(self._moves(said[: real.size], mask[real]))
        return np.concatenate(parts)

    def _moves(self, said: NDArray[Any], mask: NDArray[np.bool_]) -> NDArray[np.int64]:
        """Moves of a block, from what the model said and the masks (row, ..., 9).

        Raises `UserError` if it is neither moves nor values.
        """
        moves = said.shape == mask.shape[:-1] and said.dtype.kind in "iu"
        if moves and ((said >= 0) & (said < 9)).all():
            return said.astype(np.int64)
        if said.shape == mask.shape and said.dtype.kind == "f" and not np.isnan(said).any():
            return np.asarray(np.where(mask, said, -np.inf).argmax(axis=-1))
        raise UserError(
            f"{type(self).__name__}.decide: gave {said.dtype} of shape {said.shape}; expected "
            f"whole numbers 0-8 of shape {mask.shape[:-1]}, or values of shape {mask.shape} "
            "without NaN"
        )

    def _choose(self, rows: Rows, agent: int, moves: NDArray[np.int64]) -> None:
        self._preferences[rows, agent, moves] = CHOSEN


def _in_turn(policy: ModelPolicy, seen: Observation, rows: Rows, pictures: Arrays) -> None:
    """One agent after the other, each knowing which nodes those before it took."""
    policy._round += 1
    arrays, claimed = policy.task.arrays, policy._claimed
    for agent in policy.task.fleet.order.tolist():
        own = {name: part[:, agent] for name, part in pictures.items()}
        masks = [
            legal_of_agent(
                arrays,
                claimed[row],
                policy._round,
                agent,
                seen.agent_node[row, agent],
                seen.energy_left[row, agent],
            )
            for row in rows
        ]
        own[MASK] = np.stack(masks).astype(np.int8)
        policy._choose(rows, agent, policy._ask(own, np.full(rows.size, agent)))
        target = policy._resolver(
            seen.active,
            policy._preferences,
            seen.agent_node,
            seen.energy_left,
            seen.belief,
            seen.step,
            seen.keys,
        ).target[rows, agent]
        claimed[rows, target] = policy._round


def _masks(policy: ModelPolicy, seen: Observation, rows: Rows) -> NDArray[np.int8]:
    legal = LegalMoves(policy.task)(seen.agent_node[rows], seen.energy_left[rows])
    return legal.astype(np.int8)


def _at_once(policy: ModelPolicy, seen: Observation, rows: Rows, pictures: Arrays) -> None:
    """The whole fleet as one."""
    own = pictures | {MASK: _masks(policy, seen, rows)}
    moves = policy._ask(own, np.full(rows.size, -1))
    for agent in range(moves.shape[1]):
        policy._choose(rows, agent, moves[:, agent])


def _each(policy: ModelPolicy, seen: Observation, rows: Rows, pictures: Arrays) -> None:
    """Every agent for itself, in a row of its own."""
    own = pictures | {MASK: _masks(policy, seen, rows)}
    count = len(policy.task.fleet)
    flat = {name: part.reshape(-1, *part.shape[2:]) for name, part in own.items()}
    moves = policy._ask(flat, np.tile(np.arange(count), rows.size)).reshape(-1, count)
    for agent in range(count):
        policy._choose(rows, agent, moves[:, agent])


_VIEWS: dict[str, Callable[[ModelPolicy, Observation, Rows, Arrays], None]] = {
    "mjforage/SharedPolicy-v0": _in_turn,
    "mjforage/Foraging-v0": _at_once,
    "parallel_env": _each,
}
