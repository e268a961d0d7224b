"""A mission step by step, for loops of one's own: states as arrays with units."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.api import checks
from mjforage.api.checks import Named
from mjforage.api.functions import Move
from mjforage.api.players import Players, Policies
from mjforage.api.scenarios import on_device, scenario_of
from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.graph_planner.encodings import LegalMoves
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.mission import Mission as Core
from mjforage.mission.moves import preferences_of
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import WORLDS, World, create_mission
from mjforage.scenario.scenario import Device


class State(NamedTuple):
    """State of a mission after a decision, as copies; with a batch, episodes are a leading axis.

    Attributes
    ----------
    step : decisions made
    time_s : simulated time [s]
    over : True once all items are collected or the horizon is reached
    agent_xy_m : (agent, 2) x east, y north [m]
    agent_heading_rad : (agent,) 0 east, counter-clockwise [rad]
    agent_speed_mps : (agent,) mean over the decision [m/s]
    agent_node : (agent,) node
    energy_left_node : (agent,) distance that can still be travelled [node], inf without a limit
    item_xy_m : (item, 2) [m]; the last place of one that is collected; NaN where there is none
    item_present : (item,) True while it floats
    collected : (agent,) items that each has collected
    discovered : (item,) True once an agent has seen it
    belief : (row, column) believed items, as the fleet knows together
    legal_moves : (agent, 9) moves that are legal while nobody is in the way: N, NE, ..., NW, stay

    Examples
    --------
    >>> import mjforage as mf
    >>> state = mf.make_mission("open-bay").reset(seed=1)
    >>> state.step, state.time_s, state.agent_xy_m.shape
    (0, 0.0, (4, 2))
    """

    step: Any
    time_s: Any
    over: Any
    agent_xy_m: NDArray[np.float64]
    agent_heading_rad: NDArray[np.float64]
    agent_speed_mps: NDArray[np.float64]
    agent_node: NDArray[np.int32]
    energy_left_node: NDArray[np.float64]
    item_xy_m: NDArray[np.float64]
    item_present: NDArray[np.bool_]
    collected: NDArray[np.int64]
    discovered: NDArray[np.bool_]
    belief: NDArray[np.int16]
    legal_moves: NDArray[np.bool_]

    def __repr__(self) -> str:
        items = f"{np.sum(self.item_present)} of {np.shape(self.item_present)[-1]} items float"
        if np.ndim(self.step):
            steps = f"steps {np.min(self.step)} to {np.max(self.step)}"
            return f"State({np.size(self.step)} episodes, {steps})"
        return f"State(step {self.step}, {self.time_s:g} s, {len(self.agent_node)} agents, {items})"


class Mission:
    """A mission in one of the worlds, played step by step; made by `make_mission`.

    Examples
    --------
    >>> import mjforage as mf
    >>> mission = mf.make_mission("open-bay", horizon=20)
    >>> state = mission.reset(seed=1)
    >>> while not state.over:
    ...     state = mission.step({"scouts_0": "NE"})
    >>> state.step, state.time_s
    (20, 200.0)
    """

    def __init__(self, setup: Setup, world: str, batch: int | None, threads: int = 1) -> None:
        if not isinstance(setup, Setup):
            raise TypeError(f"setup is {type(setup).__name__}; make missions with make_mission")
        self._scenario = setup
        self._core: Core = create_mission(setup, world, threads=threads)
        self._batch, self._legal = batch, LegalMoves(setup.task)
        self._started = False

    def reset(self, *, seed: int = 0, episode: int | Sequence[int] | None = None) -> State:
        """Start an episode, or a batch of them; the same ones as `evaluate` plays of that seed.

        Parameters
        ----------
        seed : 0 to 2**64 - 1
        episode : number, 0 by default; of a batch numbers, by default 0, 1, ...

        Raises
        ------
        UserError
            If a number is out of range.
        """
        count = self._batch or 1
        several = episode.tolist() if isinstance(episode, np.ndarray) else episode
        if several is not None and not isinstance(several, Sequence):
            several = [several]
        numbers = list(range(count)) if several is None else several
        if isinstance(numbers, str) or len(numbers) != count:
            raise UserError(f"episode {episode!r}: give {count} whole number(s) from 0 on")
        chosen = [checks.whole("episode", one, 0, 2**63 - 1) for one in numbers]
        self._core.reset(checks.whole("seed", seed, 0, 2**64 - 1), np.array(chosen, np.int64))
        self._started = True
        return self.state

    def step(self, moves: Mapping[str, Move] | Sequence[Move] | NDArray[Any]) -> State:
        """Make one move with each agent.

        Parameters
        ----------
        moves : agent -> move, the others stay; or one for each agent (agent,); of a batch an array
            (episode, agent). A move is N, NE, ..., NW or stay, or its number 0 to 8. One that is
            not legal becomes staying put, or the first that is legal where staying is not

        Raises
        ------
        UserError
            If there is no such agent or move, or no episode has been started.
        """
        self._check_started("step")
        wanted = self._numbers(moves)
        self._core.advance(preferences_of(wanted))
        return self.state

    def play(self, policy: Policies) -> Iterator[State]:
        """Let a policy decide until all episodes are over; a state after every decision.

        Parameters
        ----------
        policy : in any form that `evaluate` takes

        Raises
        ------
        UserError
            If there is no such policy, or no episode has been started.
        """
        self._check_started("play")
        players = Players.of(policy)
        if len(players.names) != 1:
            raise UserError(f"play: {len(players.names)} policies; give one")
        with players.known() as names:
            player = create_policy(names[0])
        self._core.prepare(player)

        def states() -> Iterator[State]:
            while self._core.active.any():
                self._core.advance(self._core.ask(player))
                yield self.state

        return states()

    @property
    def scenario(self) -> Setup:
        """Scenario that is played."""
        return self._scenario

    @property
    def agents(self) -> tuple[str, ...]:
        """Names of the agents, in the order of all arrays."""
        return self._scenario.fleet.names

    @property
    def state(self) -> State:
        """State now; see `State`."""
        self._check_started("state")
        core, now, graph = self._core, self._core.state, self.scenario.graph
        settings = self.scenario.scenario
        exists = np.arange(now.item_node.shape[1]) < core.initial.n_items[:, None]
        item_xy = np.where(exists[..., None], graph.metres(now.item_rc), np.nan)
        legal = self._legal(now.agent_node, core.energy_left)
        found = State(
            step=core.step.copy(),
            time_s=core.step * settings.period_s,
            over=~core.active,
            agent_xy_m=graph.metres(now.agent_rc),
            agent_heading_rad=now.agent_yaw.copy(),
            agent_speed_mps=now.agent_speed * (settings.map.pitch_m / settings.period_s),
            agent_node=now.agent_node.copy(),
            energy_left_node=core.energy_left.copy(),
            item_xy_m=item_xy,
            item_present=now.item_node >= 0,
            collected=core.taken.copy(),
            discovered=core.ledger.t_discovered >= 0,
            belief=graph.grid(core.knowledge.belief).astype(np.int16),
            legal_moves=legal.astype(np.bool_),
        )
        if self._batch is not None:
            return found
        first = (part[0] for part in found)
        step, time_s, over, *arrays = first
        return State(int(step), float(time_s), bool(over), *arrays)

    def _numbers(self, moves: Any) -> NDArray[np.int64]:
        """(episode, agent) of moves."""
        count = self._batch or 1
        if isinstance(moves, Mapping):
            wanted = np.full(len(self.agents), STAY)
            for agent, move in moves.items():
                if agent not in self.agents:
                    raise UserError(f"agent {agent!r}: unknown; {nearest(str(agent), self.agents)}")
                if move is not None:
                    wanted[self.agents.index(agent)] = checks.move_number(move, "step", agent)
            return np.tile(wanted, (count, 1))
        array = np.asarray(moves, object)
        shape = (len(self.agents),) if self._batch is None else (count, len(self.agents))
        if array.shape != shape:
            raise UserError(f"moves of shape {array.shape}: give {shape}, one for each agent")
        agents = self.agents * count
        numbers = [
            STAY if one is None else checks.move_number(one, "step", agent)
            for one, agent in zip(array.ravel(), agents, strict=True)
        ]
        return np.array(numbers, np.int64).reshape(count, len(self.agents))

    def _check_started(self, what: str) -> None:
        if not self._started:
            raise UserError(f"{what}: no episode has been started; call reset first")

    def __repr__(self) -> str:
        return f"Mission({self.scenario!r})"


def make_mission(
    scenario: Setup | Named,
    *,
    world: World = "graph",
    device: Device | None = None,
    batch: int | None = None,
    threads: int = 1,
    **changes: Any,
) -> Mission:
    """A mission to be played step by step.

    Parameters
    ----------
    scenario : as of `evaluate`
    world : one of `mf.names("worlds")`
    device : as of `evaluate`
    batch : episodes side by side, the leading axis of every array; None: one, without that axis
    threads : on which a batch of hulls moves; results do not depend on it
    changes : as of `Scenario.replace`

    Raises
    ------
    UserError
        If there is no such scenario or world, or the scenario cannot be played there.

    Examples
    --------
    >>> import mjforage as mf
    >>> mission = mf.make_mission("open-bay", batch=3, horizon=5)
    >>> mission.reset(seed=1).agent_xy_m.shape
    (3, 4, 2)
    >>> for state in mission.play("greedy"):
    ...     pass
    >>> state.step.tolist()
    [5, 5, 5]
    """
    checks.one_of("world", world, WORLDS)
    number = None if batch is None else checks.whole("batch", batch, 1)
    setup = on_device(scenario_of(scenario, changes, make_mission), device, [world])
    setup.check_memory(number or 1)
    return Mission(setup, world, number, checks.whole("threads", threads, 1))
