"""Figures of `render`: the map from above, as in films of `mjforage render`.

It shows the truth: items that no agent has discovered are there too, small and dim.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.learning.environments.core import EnvironmentCore, Episodes
from mjforage.mission.mission import Mission
from mjforage.runs.episode_recording import Recording
from mjforage.scenario.vessel_files import hull_names

SIZE = 640, 480  # width and height [pixel]


class EpisodeFigure:
    """Records the path of a sub-environment, by its number in its core, and draws its present."""

    def __init__(self, env: int = 0) -> None:
        self._env = env

    def see(self, mission: Mission) -> None:
        """Take note of the state; step 0 begins anew."""
        env, state = self._env, mission.state
        self._step = int(mission.step[env])
        if self._step == 0:
            self._items = np.flatnonzero(state.item_node[env] >= 0)  # no padding for other episodes
            steps = mission.setup.scenario.horizon + 1
            self._agent_rc = np.zeros((steps, *state.agent_rc[env].shape), np.float32)
            self._pose = np.zeros((steps, *state.agent_yaw[env].shape, 3), np.float32)
            self._present = np.zeros((steps, self._items.size), np.bool_)
            self._most = 0
        self._agent_rc[self._step] = state.agent_rc[env]
        self._pose[self._step, :, :2] = mission.setup.graph.metres(state.agent_rc[env])
        self._pose[self._step, :, 2] = state.agent_yaw[env]
        self._present[self._step] = state.item_node[env, self._items] >= 0
        self._most = max(self._most, int(mission.knowledge.belief[env].max(initial=0)))

    def draw(self, core: EnvironmentCore, episodes: Episodes) -> NDArray[np.uint8]:
        """(height, width, 3) present state, from above with seed and episode in the title."""
        from mjforage.view.render import map_film  # slow to import
        from mjforage.view.render.palette import LEAST_MOST

        most = max(LEAST_MOST, self._most)
        film = map_film([self.recording(core, episodes)], SIZE, most)
        return film.frame(float(self._step))

    def recording(self, core: EnvironmentCore, episodes: Episodes) -> Recording:
        """The episode until now; of what is drawn as it is now, every step is the present."""
        setup, fleet = core.setup, core.setup.fleet
        return Recording(
            navigable=setup.grid.navigable,
            pitch_m=setup.scenario.map.pitch_m,
            horizon=setup.scenario.horizon,
            period_s=setup.scenario.period_s,
            team_names=fleet.team_names,
            agent_team=fleet.team,
            agent_collects=fleet.collects,
            vessels=hull_names(fleet, setup.scenario.physics),
            world=core.options.world,
            seed=episodes.seed,
            episode=episodes.number,
            agent_rc=self._agent_rc[: self._step + 1],
            item_present=self._present[: self._step + 1],
            t_discovered=core.mission.ledger.t_discovered[self._env, self._items],
            **self._present_fields(core.mission),
            **self._frames(core),
        )

    def _present_fields(self, mission: Mission) -> dict[str, Any]:
        """Items, belief, idleness and views as they are, at each step of a recording."""
        env, own, state = self._env, np.array([self._env]), mission.state
        grid, fleet = mission.setup.graph.grid, mission.setup.fleet
        scouts, foragers = (
            mission.times_seen(team, own)[0] > 0 for team in (fleet.discoverers, fleet.collectors)
        )
        now: dict[str, NDArray[Any]] = {
            "item_rc": state.item_rc[env, self._items].astype(np.float32),
            "belief": grid(mission.knowledge.belief[env]).astype(np.int16),
            "idleness": grid(mission.idleness(own)[0]).astype(np.float16),
            "in_view": grid(scouts + np.uint8(2) * foragers).astype(np.uint8),
        }
        return {
            name: np.broadcast_to(field, (self._step + 1, *field.shape))
            for name, field in now.items()
        }

    def _frames(self, core: EnvironmentCore) -> dict[str, Any]:
        """A frame for each step."""
        items, frames = self._items, self._step + 1
        rc = core.mission.state.item_rc[self._env, items]
        xy = core.setup.graph.metres(rc).astype(np.float32)
        return {
            "item_class": np.zeros(items.size, np.int16),
            "frame_s": core.setup.scenario.period_s,
            "track_pose": self._pose[:frames],
            "track_items": np.broadcast_to(xy, (frames, *xy.shape)),
            "track_present": self._present[:frames],
            "track_wind": np.zeros((frames, 2), np.float32),
        }
