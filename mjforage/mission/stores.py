"""Range and room aboard that vessels have left."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.views import read_only
from mjforage.mission.dynamics import Transition, taken_by
from mjforage.scenario.roles import UNLIMITED, Fleet


class Stores:
    """Energy and capacity of a fleet's roles in a batch of episodes, full at the start."""

    def __init__(self, fleet: Fleet, episodes: int) -> None:
        self._endless = bool(np.isinf(fleet.energy).all())
        self._holds = np.flatnonzero(fleet.capacity < UNLIMITED)  # whose room has an end
        self._energy = read_only(np.tile(fleet.energy, (episodes, 1)))
        self._room = read_only(np.tile(fleet.capacity, (episodes, 1)))

    def energy_left(self, state: Transition) -> NDArray[np.float64]:
        """(episode, agent) distance that can still be travelled [node].

        A hull can overdraw its budget by the way it makes beyond a straight line; then it stays.
        One that can no longer carry out moves has no range left.
        """
        if self._endless and not state.disabled.any():
            return self._energy
        left = np.maximum(self._energy - state.energy, 0.0)
        return np.where(state.disabled, 0.0, left)

    def room_left(self, state: Transition) -> NDArray[np.int64]:
        """(episode, agent) items that can still be taken aboard, `UNLIMITED` if any number."""
        if not self._holds.size:
            return self._room
        room = self._room.copy()
        room[:, self._holds] -= taken_by(state.collected_by, room.shape[1])[:, self._holds]
        return room
