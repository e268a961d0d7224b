"""Knowledge as a policy sees it: a row for each episode, or for each owner of knowledge in it."""

from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.base.views import CachedViews, read_only
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.exchange import Exchange
from mjforage.mission.knowledge import Knowledge
from mjforage.mission.task import DelayedScans, Observation, no_delayed_scans

_KNOWN = attrgetter(*Observation._fields[3:14])  # of knowledge

Episodes = tuple[NDArray[np.bool_], Int32Array, UInt64Array]
"""(episode,) each: whether they go on, the step to be decided, their keys."""


class Observing:
    """Observations of a batch of episodes whose scans reach the owners by an exchange."""

    def __init__(self, exchange: Exchange, keys: UInt64Array) -> None:
        self._exchange = exchange
        self._views = CachedViews[Knowledge]()
        self._acting = read_only(np.tile(_agent_of_owner(exchange), keys.size))
        self._nobody = read_only(np.full(keys.size, -1, np.int32))
        self._no_delayed = read_only(no_delayed_scans(keys.size))
        self.take_keys(keys)

    def take_keys(self, keys: UInt64Array) -> None:
        """Go on with episodes (episode,) of other keys."""
        self._owner_keys = read_only(np.repeat(keys, self._exchange.owners))

    def common(self, episodes: Episodes, knowledge: Knowledge) -> Observation:
        """Common knowledge of the fleet: one row per episode."""
        return self._row(*episodes, knowledge, self._no_delayed, self._nobody)

    def of_owners(self, episodes: Episodes) -> Observation:
        """Knowledge of the owners: (episode x owner) rows."""
        (active, step, keys), owner, owners = episodes, self._nobody, self._exchange.owners
        if owners > 1:
            active, step = read_only(np.repeat(active, owners)), read_only(np.repeat(step, owners))
            keys, owner = self._owner_keys, self._acting
        knowledge = self._views.of(self._exchange.knowledge)
        return self._row(active, step, keys, knowledge, self._exchange.delayed, owner)

    @staticmethod
    def _row(
        active: NDArray[np.bool_],
        step: Int32Array,
        keys: UInt64Array,
        knowledge: Knowledge,
        delayed: DelayedScans,
        owner: Int32Array,
    ) -> Observation:
        known = _KNOWN(knowledge)
        return Observation._make((active, step, keys, *known, delayed.scans, delayed.shown, owner))


def _agent_of_owner(exchange: Exchange) -> Int32Array:
    """(owner,) the agent that acts by what an owner knows, -1 if several do."""
    alone = np.bincount(exchange.owner_of, minlength=exchange.owners) == 1
    agent = np.zeros(exchange.owners, np.int32)
    agent[exchange.owner_of] = np.arange(exchange.owner_of.size)
    return np.where(alone, agent, np.int32(-1)).astype(np.int32)
