"""The mission loop, for a batch of episodes.

Decide -> move -> collect -> drift -> sense -> exchange -> log.
"""

import copy
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel
from mjforage.base.errors import UserError
from mjforage.base.randomness import UInt64Array, episode_keys
from mjforage.base.rows import put_rows, scatter_all, scatter_rows
from mjforage.base.views import CachedViews, read_only, view_of
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.device_mission import COUNT_STEP, DeviceMission, DeviceWorld
from mjforage.mission.dynamics import (
    COUNT_TAKEN,
    GOES_ON,
    Dynamics,
    Transition,
    goes_on,
    mean_drift,
    taken_by,
)
from mjforage.mission.exchange import Exchange, Ideal
from mjforage.mission.forecasts import Forecasts
from mjforage.mission.graph_dynamics import GraphDynamics
from mjforage.mission.initial_state import InitialState
from mjforage.mission.knowledge import Knowledge, Scans, idleness, times_seen
from mjforage.mission.ledger import Ledger
from mjforage.mission.link import exchange_of
from mjforage.mission.moves import Moves
from mjforage.mission.observing import Observing
from mjforage.mission.policy import Policy, UpperBound
from mjforage.mission.resolver import Ask, Resolver, check_preferences
from mjforage.mission.sensors.sensing import map_filter, no_shown
from mjforage.mission.sensors.sensing_update import SensingUpdate
from mjforage.mission.setup import Setup
from mjforage.mission.stores import Stores
from mjforage.mission.task import NEVER, GroundTruth, Observation

_ONE = np.ones(1, np.int32)


class Mission:
    """A batch of episodes of one scenario in one world; one episode is a batch of one.

    Its arrays are live, and only the mission can write to them.

    Attributes
    ----------
    exchange : Exchange, with the knowledge of the belief owners
    task : Task, the policies' part of the scenario
    step : (episode,) int32 decisions made
    active : (episode,) bool, False once an episode is over
    forecasts : calibration sums of the policy's forecasts, if it makes any
    """

    def __init__(
        self, setup: Setup, dynamics: Dynamics | None = None, exchange: Exchange | None = None
    ) -> None:
        """Compose a mission.

        Raises `UserError` if a role has a capability that no rule of the mission uses.

        Parameters
        ----------
        dynamics : the world it runs in (`mjforage.physics.worlds`); absent: the paper's graph
        exchange : rules by which scans reach the belief owners; absent: over the scenario's link
        """
        self.setup = setup
        if exchange is None:
            exchange = exchange_of(setup.scenario, len(setup.fleet))
        self.exchange: Exchange = exchange
        _check_capabilities(setup, self.exchange)
        if dynamics is None:
            about = setup.graph, setup.fleet, setup.scenario
            dynamics = GraphDynamics(*about, place=setup.grid.place)
        pickup = read_only(dynamics.pickup)
        self._asked = "policy"  # who answered last, for messages
        self.task = setup.task if pickup is None else replace(setup.task, pickup=pickup)
        self._dynamics = dynamics
        self._state_views, self._ledger_views = CachedViews[Transition](), CachedViews[Ledger]()
        self._common_views = CachedViews[Knowledge]()
        self._views, self._radius_number = self.task.views, self.task.radius_number
        self._resolver = Resolver(setup.graph, setup.fleet, setup.task.rules, setup.corruption)
        self._go_on = BoundKernel(goes_on, setup.scenario.horizon)

    def reset(self, seed: int, episodes: NDArray[np.int64]) -> None:
        """Start the given episodes of a seed.

        Parameters
        ----------
        seed : the run's seed
        episodes : (episode,) their numbers; each is the same world whatever else is in the batch
        """
        names = [f"{seed}, episode {episode}" for episode in episodes]
        self.start(episode_keys(seed, episodes), names)

    def start(self, keys: UInt64Array, names: Sequence[str] = ()) -> None:
        """Start episodes.

        Parameters
        ----------
        keys : (episode,) which decide them
        names : (episode,) for messages; absent: their keys
        """
        initial = self.setup.create_initial_state(keys)
        state = self._dynamics.reset(initial, read_only(keys), names or _names(keys))
        self._begin(keys, initial, state)

    def _begin(self, keys: UInt64Array, initial: InitialState, state: Transition) -> None:
        """Take episodes at step 0."""
        self.keys, self.initial, self._state = read_only(keys), initial, state
        self._begin_step(np.zeros(keys.size, np.int32))
        self.active = read_only(np.ones(keys.size, np.bool_))
        self._moves: Moves | None = None
        self._ledger = Ledger.of(self._state.item_node, len(self.setup.graph))
        self._stores = Stores(self.setup.fleet, keys.size)
        sensors = self.setup.scenario.sensors
        self._shown = no_shown(self.task, keys.size, sensors.perfect)
        self._filtered = map_filter(self.setup.scenario, self.task, keys.size)
        self._knowledge = Knowledge.of_starts(self._scans(), len(self.setup.graph))
        self._renew_sensing_update()
        scans = self._sense()
        if not self.setup.scenario.rules.start_seen:
            self._knowledge.last_seen[:] = NEVER
        self.exchange.reset(self.task, scans, self._knowledge, self.keys)
        self._observing = Observing(self.exchange, self.keys)
        self.forecasts = Forecasts(keys.size)

    def _scans(self) -> Scans:
        """Scans and states of all agents now."""
        return Scans(
            active=self.active,
            step=self.step,
            agent_node=self._state.agent_node,
            sighted=self._ledger.truth,
            shown=self._shown,
            energy_left=self.energy_left,
            room_left=self.room_left,
            taken=self.taken,
            pickup=self._state.pickup,
            agent_yaw=self._state.agent_yaw,
        )

    def _sense(self) -> Scans:
        """All agents scan: the fleet's knowledge and the ledger come up to date."""
        scans = self._scans()
        self._sensing_update.scan(scans, self._state.item_node, self._state.collected_by)
        return scans

    def _renew_sensing_update(self) -> None:
        about = self.task, self.setup.scenario.sensors, self.keys
        changed = self._ledger, self._knowledge, self._filtered
        self._sensing_update = SensingUpdate(*about, *changed)

    def _begin_step(self, step: Int32Array) -> None:
        """Set (episode,) the steps made so far, and that to be decided next."""
        self.step, self._next_step = view_of(step), view_of(step + _ONE)

    @property
    def state(self) -> Transition:
        """The true positions."""
        return self._state_views.of(self._state)

    @property
    def ledger(self) -> Ledger:
        """The truth and its history."""
        return self._ledger_views.of(self._ledger)

    @property
    def knowledge(self) -> Knowledge:
        """Knowledge common to the fleet: one row per episode."""
        return self._common_views.of(self._knowledge)

    @property
    def moves(self) -> Moves | None:
        """Moves of the last decision; None before the first."""
        return None if self._moves is None else read_only(self._moves)

    def restart(
        self, rows: NDArray[np.int64], keys: UInt64Array, names: Sequence[str] = ()
    ) -> InitialState:
        """Start other episodes in some rows of the batch; the rest goes on to the bit.

        So a batch goes on while some of its episodes are over, as vector environments ask. The
        state `initial` stays that of the first episodes.

        Returns: their initial state.

        Parameters
        ----------
        rows : (row,) places in the batch
        keys, names : (row,) of these episodes, as of `start`
        """
        initial = self.setup.create_initial_state(keys).padded(self._state.item_node.shape[1])
        names = names or _names(keys)
        self._state = self._dynamics.restart(rows, initial, read_only(keys), names)
        other = self._spare
        other._begin(keys, initial, Transition._make(part[rows] for part in self._state))
        nobody = set(Ledger._fields) - {"truth"}
        self._ledger = scatter_all(self._ledger, rows, other._ledger, nobody)
        self._knowledge = scatter_all(self._knowledge, rows, other._knowledge)
        self.exchange.replace_episodes(rows, other.exchange, self._knowledge)
        self._shown = put_rows(self._shown, rows, other._shown)
        self.forecasts.replace_episodes(rows, other.forecasts)
        self._filtered = self._filtered.with_rows(rows, other._filtered)
        self._begin_step(scatter_rows(self.step, rows, other.step))
        self.keys = read_only(scatter_rows(self.keys, rows, other.keys))
        self.active = read_only(scatter_rows(self.active, rows, other.active))
        self._observing.take_keys(self.keys)
        self._renew_sensing_update()
        return initial

    @cached_property
    def _spare(self) -> "Mission":
        """Knowledge in episodes that start in rows of the batch, before they are part of it."""
        return Mission(self.setup, self._dynamics, copy.copy(self.exchange))

    @property
    def energy_left(self) -> NDArray[np.float64]:
        """(episode, agent) distance that can still be travelled [node]."""
        return self._stores.energy_left(self._state)

    @property
    def room_left(self) -> NDArray[np.int64]:
        """(episode, agent) items that can still be taken aboard, `UNLIMITED` if any number."""
        return self._stores.room_left(self._state)

    @property
    def taken(self) -> NDArray[np.int64]:
        """(episode, agent) items that each has taken aboard."""
        return taken_by(self._state.collected_by, self._state.agent_node.shape[1])

    @property
    def observation(self) -> Observation:
        """Common knowledge of the fleet before the next decision: one row per episode."""
        return self._observing.common((self.active, self._next_step, self.keys), self.knowledge)

    @property
    def owner_observation(self) -> Observation:
        """Knowledge of the owners before the next decision: (episode x owner) rows."""
        return self._observing.of_owners((self.active, self._next_step, self.keys))

    @property
    def truth(self) -> GroundTruth:
        """Ground truth, which no policy may see but an oracle bound."""
        state = self.state
        drift = self._dynamics.drift_rc(state.item_rc, items=True)
        mean = mean_drift(drift, state.item_node >= 0)
        return read_only(GroundTruth(state.item_rc, state.item_node, mean, drift))

    @property
    def node_drift_rc(self) -> NDArray[np.float64]:
        """(episode, node, 2) velocity at which an item of the paper's leeway is carried in each
        node now [node/step], gusts and noise left out.
        """
        graph = self.setup.graph
        centres = np.stack((graph.rows, graph.cols), axis=1).astype(np.float64)
        places = np.broadcast_to(centres, (self.keys.size, *centres.shape))
        return read_only(self._dynamics.drift_rc(places))

    def idleness(self, episodes: NDArray[np.int64]) -> NDArray[np.float64]:
        """(chosen, node) idleness in [0, 1] of some episodes (chosen,), as the fleet knows it."""
        return idleness(self.knowledge.last_seen, self.step, episodes, self.task.forgetting)

    def times_seen(
        self, agents: NDArray[np.int64], episodes: NDArray[np.int64]
    ) -> NDArray[np.uint8]:
        """(chosen, node) by how many of `agents` each node is in view, in some episodes."""
        at = self.state.agent_node[episodes]
        about = self._views, self._radius_number, self._shown[episodes]
        return times_seen(at, agents, *about)

    def prepare(self, policy: Policy) -> None:
        """Get a policy ready for the batch: it decides once for each owner, a bound for each
        episode unless it is `decentralised`. Networks decide where the hulls are.
        """
        pooled = isinstance(policy, UpperBound) and not getattr(policy, "decentralised", False)
        if hasattr(policy, "network_device"):
            policy.network_device = getattr(self._dynamics, "network_device", "cpu")
        policy.reset(self.task, np.repeat(self.keys, 1 if pooled else self.exchange.owners))

    def ask(self, policy: Policy) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9) of a policy, those of each agent by its own knowledge.

        An oracle upper bound (`UpperBound`) gets the truth too, and what the fleet knows together
        unless it is `decentralised`. Raises `UserError` if the answer is no array of numbers of
        that shape.
        """
        self._asked = who = f"policy {type(policy).__name__}"
        set_ground_truth = getattr(
            policy, "set_ground_truth", None
        )  # `isinstance` of a protocol takes 25 us
        decentralised = set_ground_truth is None or getattr(policy, "decentralised", False)
        owners, owner_of = self.exchange.owners if decentralised else 1, self.exchange.owner_of
        if set_ground_truth is not None:
            truth = self.truth
            rows = truth if owners == 1 else (np.repeat(a, owners, 0) for a in truth)
            set_ground_truth(read_only(GroundTruth._make(rows)))
        answer = policy.act(self.owner_observation if decentralised else self.observation)
        forecast = getattr(policy, "forecast", None)
        if forecast is not None:
            self.forecasts.take(forecast(), self._ledger.truth, self.active, who)
        check_preferences(answer, (self.keys.size * owners, owner_of.size), who)
        if owners == 1:
            return answer
        each = answer.reshape(self.keys.size, owners, *answer.shape[1:])
        own: NDArray[np.float64] = each[:, owner_of, np.arange(owner_of.size)]
        return own

    def decide(self, preferences: NDArray[np.float64]) -> Moves:
        """Resolve preferences (episode, agent, 9) into moves without making them."""
        return self._resolver(
            self.active,
            preferences,
            self._state.agent_node,
            self._knowledge.energy_left,
            self.exchange.knowledge.belief,
            self._next_step,
            self.keys,
            self.exchange.owner_of,
            self._asked,
        )

    def advance(self, preferences: NDArray[np.float64]) -> Transition:
        """One step of every active episode.

        Raises `UserError` if the preferences have the wrong shape, are no numbers or contain NaN.

        `preferences`: (episode, agent, 9), see `Resolver`.
        """
        self._moves = self.decide(preferences)
        self._begin_step(self.step + self.active)
        self._state = self._dynamics.advance(self.active, self.step, self._moves)
        self.exchange.update(self._sense(), self._knowledge)
        item_node = np.ascontiguousarray(self._state.item_node, np.int32)
        going = np.empty(self.active.size, np.bool_)
        self._go_on(self.active, self.step, item_node, going)
        self.active = view_of(going)
        return self.state

    @property
    def may_decide_on_device(self) -> bool:
        """True if whole decisions can be there: hulls with bodies for items, an ideal link."""
        there = getattr(self._dynamics, "may_decide_on_device", False)
        return bool(there) and isinstance(self.exchange, Ideal)

    def on_device(self) -> DeviceMission:
        """The batch on the device of its hulls, see `may_decide_on_device` and `came_back`."""
        world: DeviceWorld = cast(Any, self._dynamics).on_device()
        bind, active, state, known = world.bind, world.active, self._state, self._knowledge
        active[:], step, following = self.active, self.step.copy(), self._next_step.copy()
        shape, moves = state.agent_node.shape, Moves.of(state.agent_node.shape)
        preferences, energy = np.zeros((*shape, 9)), np.zeros(shape)
        room, taken = np.zeros((2, *shape), np.int64)
        alone = np.zeros(shape[1], np.int64)
        about = state.agent_node, known.energy_left, known.belief, alone, following, self.keys
        scans = self._scans()._replace(
            active=active, step=step, energy_left=energy, room_left=room, taken=taken
        )
        seen = self._observing.common((active, following, self.keys), known)
        calls = (
            self._resolver.on_device(bind, Ask(active, preferences, *about), moves),
            bind(COUNT_STEP, active, step, following),
            *world.deciding(moves),
            bind(COUNT_TAKEN, state.collected_by, taken),
            self._stores.on_device(bind, state, taken, energy, room),
            self._sensing_update.on_device(bind, scans, state),
            bind(GOES_ON, self.setup.scenario.horizon, active, step, state.item_node, active),
        )
        changed = known, state, self._ledger, active, step, moves
        return DeviceMission(world, calls, preferences, seen, *changed)

    def came_back(self, device: DeviceMission) -> None:
        """Take in how far decisions on a device have come."""
        self._begin_step(device.step.copy())
        self.active = view_of(device.active.copy())
        self._moves = Moves._make(part.copy() for part in device.moves)

    def run(self, policy: Policy, observers: "tuple[Observer, ...]" = ()) -> None:
        """Play the batch to its end, showing every state to the observers."""
        self.prepare(policy)
        for observer in observers:
            observer.see(self)
        while self.active.any():
            self.advance(self.ask(policy))
            for observer in observers:
                observer.see(self)


def _names(keys: UInt64Array) -> list[str]:
    return [f"key {key}" for key in keys]


def _check_capabilities(setup: Setup, exchange: Exchange) -> None:
    """Refuse what a role can do and nothing uses, rather than run as if it could not."""
    for name, role in setup.scenario.team.items():
        for capability in ("carries", "relays"):
            if getattr(role, capability) and capability not in exchange.uses:
                raise UserError(
                    f"scenario {setup.scenario.name}: team.{name}.{capability} = true, but no rule "
                    "of this mission uses it; leave it out"
                )


class Observer:
    """Something that scans at a mission after its reset and after every step."""

    def see(self, mission: Mission) -> None:
        """Take what is wanted from the mission; its arrays are live: copy what shall last."""
        raise NotImplementedError
