"""Batched core of the foraging environments: episodes that start and end on their own."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.encodings import LegalMoves, create_encoder
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.learning.environments.checks import checked_seed, checked_started
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.environments.rewards import RewardTerms
from mjforage.mission.moves import preferences_of
from mjforage.physics.worlds import create_mission


@dataclass(frozen=True)
class Outcome:
    """Result of one step."""

    terms: dict[str, NDArray[np.float64]]  # name -> (env, agent) weighted
    rewards: NDArray[np.float64]  # (env, agent) their sum
    terminated: NDArray[np.bool_]  # (env,) no item is left, or nobody can move
    truncated: NDArray[np.bool_]  # (env,) the horizon is reached with items left
    illegal: NDArray[np.int64]  # (env,) chosen moves that were not legal, or taken by another
    exhausted: NDArray[np.bool_]  # (env, agent) see `Task.exhausted`
    taken: NDArray[np.int8]  # (env, agent) moves that were made
    sums: dict[str, NDArray[np.float64]]  # `terms` of the episode so far; live


@kernel
def _share_happened(when: NDArray[np.int16], items: Int32Array) -> NDArray[np.float64]:
    """(env,) share of items (env,) of which something happened [%]."""
    shares = np.zeros(when.shape[0])
    for e in range(when.shape[0]):
        count = 0
        for k in range(when.shape[1]):
            count += when[e, k] >= 0
        shares[e] = 100.0 * count / items[e]
    return shares


@kernel
def _how_it_ended(
    played: NDArray[np.bool_],
    active: NDArray[np.bool_],
    wanted: NDArray[np.int64],
    taken: NDArray[np.int8],
    exhausted: NDArray[np.bool_],
    item_node: Int32Array,
) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.int64]]:
    """`terminated`, `truncated` and `illegal` of `Outcome`."""
    terminated, truncated = np.zeros(played.size, np.bool_), np.zeros(played.size, np.bool_)
    illegal = np.zeros(played.size, np.int64)
    for e in range(played.size):
        if not played[e]:
            continue
        left, able = False, False
        for k in range(item_node.shape[1]):
            left |= item_node[e, k] >= 0
        for a in range(taken.shape[1]):
            illegal[e] += taken[e, a] != wanted[e, a]
            able |= not exhausted[e, a]
        terminated[e] = not (left and able)
        truncated[e] = not (terminated[e] or active[e])
    return terminated, truncated, illegal


class EnvironmentCore:
    """Sub-environments, an episode in each; one is started again whenever its user wants.

    Attributes
    ----------
    on_device : True if what agents see is tensors on a device
    """

    on_device = False

    def __init__(
        self,
        options: EnvironmentOptions,
        num_envs: int = 1,
        turns: int = 1,
        threads: int = 1,
    ) -> None:
        """Prepare.

        Raises `UserError` if this machine has not the memory for them.

        Parameters
        ----------
        num_envs : episodes side by side
        turns : steps of the environment in one of the mission, for discounts of a reward
        threads : see `create_mission`
        """
        self.options, self.num_envs = options, num_envs
        self.setup = options.setup
        self.setup.check_memory(num_envs)
        self.agents = len(self.setup.fleet)
        self.mission = create_mission(self.setup, options.world, threads=threads)
        self._weights = options.weights
        self._terms = RewardTerms(self.setup.task, self._weights, turns)
        self._sums = {name: np.zeros((num_envs, self.agents)) for name in self._weights}
        self._share_happened = BoundKernel(_share_happened)
        self._legal_moves = LegalMoves(self.setup.task)
        self._encoder = create_encoder(options.observation, self.setup.task)
        self.shapes = self._encoder.shapes
        self.started = False  # whether there are episodes

    def start(self, envs: NDArray[np.int64], keys: UInt64Array) -> None:
        """Start episodes of the given keys in sub-environments (env,); the first time in all."""
        for total in self._sums.values():
            total[envs] = 0.0
        if not self.started or envs.size == self.num_envs:
            self.mission.start(keys)
            self._encoder.reset(self.num_envs * self.mission.exchange.owners)
            self.n_items = self.mission.initial.n_items.copy()
            self.started = True
            return
        self.n_items[envs] = self.mission.restart(envs, keys).n_items

    def step(self, actions: NDArray[np.int64]) -> Outcome:
        """Play one decision of every sub-environment that is not over.

        Raises `UserError` if no episode has been started.

        `actions`: (env, agent) moves 0-8; an illegal one, or one that another agent took first,
        becomes staying put where that is legal, else the first legal compass move.
        """
        checked_started(self.started, "step")
        return self.play(preferences_of(actions), actions)

    def play(
        self, preferences: NDArray[np.float64], wanted: NDArray[np.int64] | None = None
    ) -> Outcome:
        """Play one decision by preferences (env, agent, 9), see `Resolver`.

        `wanted`: (env, agent) moves that count as illegal where another is made; absent: those of
        the largest preferences.
        """
        mission, played = self.mission, self.mission.active.copy()
        wanted = preferences.argmax(axis=-1) if wanted is None else wanted
        raw = self._advance(preferences, played)
        assert mission.moves is not None, "a mission that has advanced has moved"
        taken = mission.moves.direction
        terms = {name: self._weights[name] * value for name, value in raw.items()}
        rewards = sum(terms.values(), np.zeros(taken.shape))
        for name, value in terms.items():
            self._sums[name] += value
        exhausted, left = self.exhausted, mission.state.item_node
        ends = _how_it_ended(played, mission.active, wanted, taken, exhausted, left)
        return Outcome(terms, rewards, *ends, exhausted, taken, self._sums)

    def _advance(
        self, preferences: NDArray[np.float64], played: NDArray[np.bool_]
    ) -> dict[str, NDArray[np.float64]]:
        """One decision; the terms of the reward (env, agent), 0 where nothing was played."""
        self._terms.before(self.mission)
        self.mission.advance(preferences)
        return self._terms.after(self.mission, played)

    @property
    def exhausted(self) -> NDArray[np.bool_]:
        """(env, agent) see `Task.exhausted`."""
        return self.setup.task.exhausted(self.mission.knowledge.energy_left)

    @property
    def masks(self) -> NDArray[np.int8]:
        """(env, agent, 9) 1 where a move is legal whatever the others choose."""
        known = self.mission.knowledge
        return self._legal_moves(known.agent_node, known.energy_left).view(np.int8)

    def of(self, env: int) -> tuple["EnvironmentCore", int]:
        """The core that plays a sub-environment, and its number there."""
        return self, env

    def come_back(self, maps: bool = True) -> None:
        """Have `mission` know all; it does, but where decisions are on a device.

        `maps`: also what is known of each node.
        """

    def see(self, envs: NDArray[np.int64]) -> dict[str, NDArray[np.uint8]]:
        """Levels (env, agent, ...) of the observation; live, only `envs` are of this moment.

        Every agent sees its own knowledge: over a link, what it has seen and received itself.
        """
        exchange, held = self.mission.exchange, self.mission.owner_observation
        if exchange.owners == 1:
            return self._encoder.see(held, envs)
        rows = (envs[:, None] * exchange.owners + np.arange(exchange.owners)).reshape(-1)
        batch, agents = (self.num_envs, exchange.owners), np.arange(self.agents)
        return {
            name: level.reshape(*batch, *level.shape[1:])[:, exchange.owner_of, agents]
            for name, level in self._encoder.see(held, rows).items()
        }

    def facts(self) -> dict[str, NDArray[Any]]:
        """Steps (env,) made, and shares (env,) of items discovered and removed so far [%]."""
        entries, shares = self.mission.ledger, {}
        for name, when in (("pta_d", entries.t_discovered), ("pta_c", entries.t_collected)):
            shares[name] = self._share_happened(when, self.n_items)
        return {"step": self.mission.step.astype(np.int64), **shares}

    def fact(self) -> dict[str, float]:
        """The same of the first sub-environment, as plain numbers."""
        return {name: values[0].item() for name, values in self.facts().items()}


class Episodes:
    """Numbers a sub-environment's episodes: seed and number decide an episode, nothing else."""

    def __init__(self) -> None:
        self.seed, self.number = 0, -1  # of the present episode

    def following(self, seed: int | None, entropy: np.random.Generator) -> UInt64Array:
        """Key (1,) of the next episode: the first of a new seed, else the next of the old one.

        Raises `UserError` if the seed is not one.
        """
        from mjforage.base.randomness import episode_keys

        seed = checked_seed(seed)
        if seed is not None:
            self.seed, self.number = seed, -1
        elif self.number < 0:
            self.seed = int(entropy.integers(1 << 63))
        self.number += 1
        return episode_keys(self.seed, np.array([self.number]))
