"""Figures of `render`: the map from above, as in films of `mjforage render`, or hulls in 3-D.

It shows the truth: items that no agent has discovered are there too, small and dim.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.learning.environments.core import EnvironmentCore, Episodes
from mjforage.learning.environments.harbour_figure import HarbourFigure
from mjforage.mission.mission import Mission
from mjforage.runs.episode_recording import Recording
from mjforage.scenario.vessel_files import hull_names

SIZE = 640, 480  # width and height [pixel]


class EpisodeFigure:
    """Remembers the way of one sub-environment, and draws its present.

    Parameters
    ----------
    env : number of the sub-environment in its core
    camera : name of a view in 3-D, None for the map from above
    """

    def __init__(self, env: int = 0, camera: str | None = None) -> None:
        self._env = env
        self._harbour = HarbourFigure(camera) if camera else None

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
            if self._harbour is not None:
                self._harbour.close()
        self._agent_rc[self._step] = state.agent_rc[env]
        self._pose[self._step, :, :2] = mission.setup.graph.metres(state.agent_rc[env])
        self._pose[self._step, :, 2] = state.agent_yaw[env]
        self._present[self._step] = state.item_node[env, self._items] >= 0
        self._most = max(self._most, int(mission.knowledge.belief[env].max(initial=0)))

    def draw(self, core: EnvironmentCore, episodes: Episodes) -> NDArray[np.uint8]:
        """(height, width, 3) present state, from above with seed and episode in the title."""
        from mjforage.view.render import map_film  # slow to import
        from mjforage.view.render.palette import LEAST_MOST

        replay = self._replay(core, episodes)
        if self._harbour is not None:
            return self._harbour.draw(replay, self._step)
        most = max(LEAST_MOST, self._most)
        return map_film([replay], SIZE, most).frame(float(self._step))

    def close(self) -> None:
        """Give OpenGL back, if it draws."""
        if self._harbour is not None:
            self._harbour.close()

    def _replay(self, core: EnvironmentCore, episodes: Episodes) -> Recording:
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
            t_discovered=core.mission.ledger.entries.t_discovered[self._env, self._items],
            **self._present_fields(core.mission),
            **self._track(core),
        )

    def _present_fields(self, mission: Mission) -> dict[str, Any]:
        """Items, belief, idleness and views as they are, at each step of a replay."""
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

    def _track(self, core: EnvironmentCore) -> dict[str, Any]:
        """The core's recorded track; a frame for each step where it records none."""
        trajectory, items, frames = core.trajectory, self._items, self._step + 1
        if trajectory is None:
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
        from mjforage.physics.dynamics.fleet_scene import item_choices
        from mjforage.physics.dynamics.item_bodies import draw_classes

        mission, choices = core.mission, item_choices(core.setup.scenario.physics)
        classes = draw_classes(mission.keys, mission.initial.item_node, choices)[0]
        return {
            "item_class": classes[items].astype(np.int16),
            "frame_s": trajectory.interval_s,
            "track_pose": trajectory.pose,
            "track_items": trajectory.items[:, items],
            "track_present": trajectory.present[:, items],
            "track_wind": trajectory.wind,
        }
