"""The log of a batch of episodes: trajectories and events."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage import metrics
from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.views import read_only
from mjforage.mission.dynamics import Transition
from mjforage.mission.mission import Mission, Observer
from mjforage.mission.moves import Moves

_STATE_TYPES = (
    *("i4", "f8", "f8", "f8", "i1", "f8", "i4", "i2", "f8", "f8", "i4", "f8", "f8", "i1", "?"),
)  # of the fields of `Transition`
_TRACK_TYPES = (
    *("i4", "f4", "f4", "f4", "f4", "f4", "i4", "f4", "f4", "i1", "i1", "i1", "i4"),
)  # of the fields of `Tracks`


class Tracks(NamedTuple):
    """Tracks of every agent in every step: attributes of `EpisodeLog` of these names."""

    agent_node: NDArray[np.int32]
    agent_rc: NDArray[np.float32]
    yaw: NDArray[np.float32]
    speed: NDArray[np.float32]
    distance: NDArray[np.float32]
    energy: NDArray[np.float32]
    collisions: NDArray[np.int32]
    impact: NDArray[np.float32]
    work: NDArray[np.float32]
    outcome: NDArray[np.int8]
    pickup: NDArray[np.int8]
    direction: NDArray[np.int8]
    target: NDArray[np.int32]


@kernel
def _write_down(
    tracks: Tracks,
    episodes: NDArray[np.int64],
    step: NDArray[np.int32],
    state: Transition,
    moves: Moves,
    moved: bool,
) -> None:
    """Log the state of some episodes at their steps; their moves only if they have `moved`."""
    agent_node, agent_rc, yaw, speed, distance, energy = tracks[:6]
    collisions, impact, work, outcome, pickup, direction, target = tracks[6:]
    for e in episodes:
        t = step[e]
        for a in range(agent_node.shape[2]):
            agent_node[e, t, a] = state.agent_node[e, a]
            agent_rc[e, t, a, 0] = state.agent_rc[e, a, 0]
            agent_rc[e, t, a, 1] = state.agent_rc[e, a, 1]
            yaw[e, t, a] = state.agent_yaw[e, a]
            speed[e, t, a] = state.agent_speed[e, a]
            distance[e, t, a] = state.distance[e, a]
            energy[e, t, a] = state.energy[e, a]
            collisions[e, t, a] = state.collisions[e, a]
            impact[e, t, a] = state.impact[e, a]
            work[e, t, a] = state.work[e, a]
            outcome[e, t, a] = state.outcome[e, a]
            pickup[e, t, a] = state.pickup[e, a]
            if moved:
                direction[e, t, a] = moves.direction[e, a]
                target[e, t, a] = moves.target[e, a]


class EpisodeLog(Observer):
    """Logs a batch while it runs.

    Attributes
    ----------
    agent_node : (episode, T + 1, agent) int32
    agent_rc : (episode, T + 1, agent, 2) position (row, column) [node]
    yaw : (episode, T + 1, agent) [rad]; speed [node/step]; distance [node]; energy
    collisions, impact, work : the same shape; so far, fastest in the step [m/s], so far [J]
    direction, target : (episode, T + 1, agent) the decision: 0-7 compass, 8 stay, and its node;
        -1 and the start at step 0
    outcome : (episode, T + 1, agent) int8, see `mjforage.mission.dynamics`; step 0 has no meaning
    pickup : (episode, T + 1, agent) int8, see `mjforage.mission.task.PICKUPS`
    length : (episode,) decisions made
    t_discovered, discovered_by, t_collected, collected_by : (episode, item), -1 never and none
    keys : (episode,) of the batch
    n_items : (episode,); items beyond it are padding
    item_start : (episode, item, 2) initial position (row, column) [node]
    link : traffic over the links, None without; of a batch that is over
    forecasts : (episode, bin, 4) how they came true, see `mjforage.metrics.calibration`; likewise
    item_node : (episode, T + 1, item) where each was, -1 nowhere; empty without a link
    seen : (open,) rows that the last `see` has written: those not over before it
    """

    def __init__(self, mission: Mission) -> None:
        self._started = False
        self._open = np.zeros(0, np.bool_)  # (episode,) not over when last seen

    def see(self, mission: Mission) -> None:
        """Append the mission's state; the first call allocates."""
        if not self._started:
            self._start(mission)
            self.seen = np.arange(mission.step.size)
        else:
            self.seen = np.flatnonzero(self._open)
        self.seen = read_only(self.seen)
        self._write(mission, self.seen)
        self._open = mission.active.copy()
        self.length = mission.step.copy()
        if not self._open.any():
            self._finish(mission)

    def _start(self, mission: Mission) -> None:
        self._started = True
        steps = mission.setup.scenario.horizon + 1
        episodes, agents = mission.state.agent_node.shape
        shape = (episodes, steps, agents)
        self.keys, self.n_items = mission.keys, mission.initial.n_items
        self.item_start = mission.initial.item_rc
        tracks = Tracks(*(np.zeros(shape, kind) for kind in _TRACK_TYPES))
        tracks = tracks._replace(agent_rc=np.zeros((*shape, 2), np.float32))
        tracks.direction[:] = -1
        tracks.target[:, 0] = mission.state.agent_node
        self.agent_node, self.agent_rc, self.yaw, self.speed = tracks[:4]
        self.distance, self.energy, self.collisions, self.impact, self.work = tracks[4:9]
        self.outcome, self.pickup, self.direction, self.target = tracks[9:]
        self._linked = mission.exchange.link_log is not None
        items = self.item_start.shape[1] if self._linked else 0
        self.item_node = np.full((episodes, steps, items), -1, np.int32)
        self._write_down = BoundKernel(_write_down, tracks)
        at_rest = np.zeros((episodes, agents), np.int8)
        nowhere = at_rest.astype(np.int32)
        self._no_moves = Moves(at_rest, nowhere, at_rest, at_rest.astype(np.bool_))

    def _write(self, mission: Mission, episodes: NDArray[np.int64]) -> None:
        state, moves = mission.state, mission.moves
        self._write_down(
            episodes,
            mission.step,
            Transition(*map(np.ascontiguousarray, state, _STATE_TYPES)),
            self._no_moves if moves is None else moves,
            moves is not None,
        )
        if self._linked:
            where = mission.ledger.counted_node[episodes]
            self.item_node[episodes, mission.step[episodes]] = where

    def _finish(self, mission: Mission) -> None:
        entries, self.link = mission.ledger, mission.exchange.link_log
        self.forecasts = mission.forecasts.sums
        self.t_discovered, self.discovered_by = entries.t_discovered, entries.discovered_by
        self.t_collected, self.collected_by = entries.t_collected, entries.collected_by
        for name, mine in vars(self).items():
            setattr(self, name, read_only(mine))

    def event_table(self) -> metrics.EventTable:
        """The items' events of a batch that is over: (episode, item)."""

        def times(values: NDArray[np.int16]) -> NDArray[np.float64]:
            return np.where(values < 0, metrics.NEVER, values.astype(np.float64))

        exists = np.arange(self.t_discovered.shape[1])[None, :] < self.n_items[:, None]
        return metrics.EventTable(
            times(self.t_discovered),
            self.discovered_by.astype(np.int64),
            times(self.t_collected),
            self.collected_by.astype(np.int64),
            exists,
        )
