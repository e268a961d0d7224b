"""What a batch of episodes leaves behind: trajectories, events and the metrics of every step."""

import numpy as np
from numpy.typing import NDArray

from metrics import coverage_overlap, mean_idleness, model_error
from mjforage.core.mission import Mission, Observer

STEP_METRICS = ("rmse", "rmse_columns", "mi", "co_scouts", "co_foragers")


class EpisodeLog(Observer):
    """Logs a batch while it runs. Series are padded with their last value up to the horizon.

    Attributes
    ----------
    agent_node : (episode, T + 1, agent) int32
    agent_rc : (episode, T + 1, agent, 2) position (row, column) [node]
    yaw : (episode, T + 1, agent) [rad]; speed [node/step]; distance [node]; energy
    collisions, impact, work : the same shape; so far, fastest in the step [m/s], so far [J]
    direction, target : (episode, T + 1, agent) the decision: 0-7 compass, 8 stay, and its node;
        -1 and the start at step 0
    outcome : (episode, T + 1, agent) int8, see `mjforage.core.dynamics`; step 0 is not meaningful
    series : name of `STEP_METRICS` -> (episode, T + 1)
    length : (episode,) decisions made
    t_discovered, discovered_by, t_collected, collected_by : (episode, item), -1 never and nobody
    n_items : (episode,); items beyond it are padding
    item_start : (episode, item, 2) initial position (row, column) [node]
    """

    def __init__(self, mission: Mission) -> None:
        self._scouts = mission.setup.fleet.discoverers
        self._foragers = mission.setup.fleet.collectors
        self._navigable = mission.setup.grid.navigable
        self._started = False
        self._open = np.zeros(0, np.bool_)  # (episode,) not over when last seen

    def see(self, mission: Mission) -> None:
        """Append the mission's state; the first call allocates."""
        if not self._started:
            self._start(mission)
            everyone = np.arange(mission.step.size)
        else:
            everyone = np.flatnonzero(self._open)
        self._write(mission, everyone)
        self._open = mission.active.copy()
        self.length = mission.step.copy()
        if not self._open.any():
            self._finish(mission)

    def _start(self, mission: Mission) -> None:
        self._started = True
        steps = mission.setup.scenario.horizon + 1
        episodes, agents = mission.state.agent_node.shape
        shape = (episodes, steps, agents)
        self.n_items = mission.initial.n_items
        self.item_start = mission.initial.item_rc
        self.agent_node = np.zeros(shape, np.int32)
        self.agent_rc = np.zeros((*shape, 2), np.float32)
        self.yaw = np.zeros(shape, np.float32)
        self.speed = np.zeros(shape, np.float32)
        self.distance = np.zeros(shape, np.float32)
        self.energy = np.zeros(shape, np.float32)
        self.collisions = np.zeros(shape, np.int32)
        self.impact = np.zeros(shape, np.float32)
        self.work = np.zeros(shape, np.float32)
        self.outcome = np.zeros(shape, np.int8)
        self.direction = np.full(shape, -1, np.int8)
        self.target = np.zeros(shape, np.int32)
        self.target[:, 0] = mission.state.agent_node
        self.series = {name: np.full((episodes, steps), np.nan) for name in STEP_METRICS}

    def _write(self, mission: Mission, episodes: NDArray[np.int64]) -> None:
        state = mission.state
        at = (episodes, mission.step[episodes])
        self.agent_node[at] = state.agent_node[episodes]
        self.agent_rc[at] = state.agent_rc[episodes]
        self.yaw[at] = state.agent_yaw[episodes]
        self.speed[at] = state.agent_speed[episodes]
        self.distance[at] = state.distance[episodes]
        self.energy[at] = state.energy[episodes]
        self.collisions[at] = state.collisions[episodes]
        self.impact[at] = state.impact[episodes]
        self.work[at] = state.work[episodes]
        self.outcome[at] = state.outcome[episodes]
        if mission.moves is not None:
            self.direction[at] = mission.moves.direction[episodes]
            self.target[at] = mission.moves.target[episodes]
        truth = mission.ledger.entries.truth[episodes]
        belief = mission.knowledge.belief[episodes]
        rmse, rmse_columns = model_error(truth, belief, self._navigable)
        self.series["rmse"][at], self.series["rmse_columns"][at] = rmse, rmse_columns
        self.series["mi"][at] = mean_idleness(mission.idleness(episodes))
        for name, team in (("co_scouts", self._scouts), ("co_foragers", self._foragers)):
            self.series[name][at] = coverage_overlap(mission.times_seen(team, episodes))

    def _finish(self, mission: Mission) -> None:
        steps = np.arange(mission.setup.scenario.horizon + 1)
        last = np.minimum(steps[None, :], self.length[:, None])
        for name, values in self.series.items():
            self.series[name] = np.take_along_axis(values, last, axis=1)
        entries = mission.ledger.entries
        self.t_discovered, self.discovered_by = entries.t_discovered, entries.discovered_by
        self.t_collected, self.collected_by = entries.t_collected, entries.collected_by
