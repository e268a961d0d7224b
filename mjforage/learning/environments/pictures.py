"""`rgb_array`: the map from above as it is now, drawn like the films of `mjforage render`.

It shows the truth: items that no agent has discovered are there too, small and dim.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.core.mission import Mission
from mjforage.learning.environments.game import Episodes, Game
from mjforage.runs.episode_replay import Replay

LONG_SIDE = 640  # pixels


class Picture:
    """Remembers one sub-environment step by step, and draws its present."""

    def __init__(self, env: int = 0) -> None:
        self._env = env
        self._steps: list[dict[str, NDArray[Any]]] = []

    def see(self, mission: Mission) -> None:
        """Take note of the state; step 0 begins anew."""
        env, state, model = self._env, mission.state, mission.model
        if mission.step[env] == 0:
            self._steps = []
        grid, fleet = mission.setup.graph.grid, mission.setup.fleet
        idle = model.idleness(mission.step, np.array([env]))[0]
        scouts, foragers = (
            model.times_seen(state.agent_node[env : env + 1], team)[0] > 0
            for team in (fleet.discoverers, fleet.collectors)
        )
        self._steps.append(
            {
                "agent_rc": state.agent_rc[env].astype(np.float32),
                "item_rc": state.item_rc[env].astype(np.float32),
                "item_present": state.item_node[env] >= 0,
                "belief": grid(model.knowledge.belief[env]).astype(np.int16),
                "idleness": grid(idle).astype(np.float16),
                "in_view": grid(scouts + np.uint8(2) * foragers).astype(np.uint8),
            }
        )

    def draw(self, game: Game, episodes: Episodes) -> NDArray[np.uint8]:
        """(height, width, 3) what is there now, with the seed and episode in the title."""
        from mjforage.view.render import TopView  # matplotlib-free, but slow to import

        items = self._steps[0]["item_present"]  # padding for other episodes is left out
        arrays: dict[str, Any] = {
            name: np.stack([step[name] for step in self._steps]) for name in self._steps[0]
        }
        for name in ("item_rc", "item_present"):
            arrays[name] = arrays[name][:, : items.size][:, items]
        setup, fleet = game.setup, game.setup.fleet
        replay = Replay(
            navigable=setup.grid.navigable,
            pitch_m=setup.scenario.map.pitch_m,
            horizon=setup.scenario.horizon,
            period_s=setup.scenario.period_s,
            team_names=fleet.team_names,
            agent_team=fleet.team,
            agent_collects=fleet.collects,
            vessels=("",) * len(fleet),
            item_class=np.zeros(int(items.sum()), np.int16),
            frame_s=setup.scenario.period_s,
            track_pose=np.zeros((1, len(fleet), 3), np.float32),
            track_items=np.zeros((1, int(items.sum()), 2), np.float32),
            track_present=np.zeros((1, int(items.sum())), np.bool_),
            track_wind=np.zeros((1, 2), np.float32),
            world=game.options.world,
            seed=episodes.seed,
            episode=episodes.number,
            **arrays,
        )
        view = TopView(replay, LONG_SIDE)
        return view.frame(float(view.length))
