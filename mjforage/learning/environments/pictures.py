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
        env, state = self._env, mission.state
        if mission.step[env] == 0:
            self._steps, self._items = [], np.flatnonzero(state.item_node[env] >= 0)
        grid, fleet = mission.setup.graph.grid, mission.setup.fleet
        own, items = np.array([env]), self._items  # without the padding for other episodes
        scouts, foragers = (
            mission.times_seen(team, own)[0] > 0 for team in (fleet.discoverers, fleet.collectors)
        )
        self._steps.append(
            {
                "agent_rc": state.agent_rc[env].astype(np.float32),
                "item_rc": state.item_rc[env, items].astype(np.float32),
                "item_present": state.item_node[env, items] >= 0,
                "belief": grid(mission.knowledge.belief[env]).astype(np.int16),
                "idleness": grid(mission.idleness(own)[0]).astype(np.float16),
                "in_view": grid(scouts + np.uint8(2) * foragers).astype(np.uint8),
            }
        )
        self._found = mission.ledger.entries.t_discovered[env, items]

    def draw(self, game: Game, episodes: Episodes) -> NDArray[np.uint8]:
        """(height, width, 3) what is there now, with the seed and episode in the title."""
        from mjforage.view.render import TopView  # matplotlib-free, but slow to import

        arrays: dict[str, Any] = {
            name: np.stack([step[name] for step in self._steps]) for name in self._steps[0]
        }
        setup, fleet, items = game.setup, game.setup.fleet, self._items.size
        replay = Replay(
            navigable=setup.grid.navigable,
            pitch_m=setup.scenario.map.pitch_m,
            horizon=setup.scenario.horizon,
            period_s=setup.scenario.period_s,
            team_names=fleet.team_names,
            agent_team=fleet.team,
            agent_collects=fleet.collects,
            vessels=("",) * len(fleet),
            item_class=np.zeros(items, np.int16),
            frame_s=setup.scenario.period_s,
            track_pose=np.zeros((1, len(fleet), 3), np.float32),
            track_items=np.zeros((1, items, 2), np.float32),
            track_present=np.zeros((1, items), np.bool_),
            track_wind=np.zeros((1, 2), np.float32),
            world=game.options.world,
            seed=episodes.seed,
            episode=episodes.number,
            t_discovered=self._found,
            **arrays,
        )
        view = TopView(replay, LONG_SIDE)
        return view.frame(float(view.length))
