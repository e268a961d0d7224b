"""The state of an episode, for central critics: common knowledge of the fleet, and the truth.

No agent sees it: over a link each acts by what it has seen and received itself.
"""

import gymnasium
import numpy as np
from numpy.typing import NDArray

from mjforage.graph_planner.encodings.encoder import MOST_ITEMS
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.scenario.roles import UNLIMITED

CHANNELS = (
    *("water", "idleness", "belief", "items", "time"),
    *("drift south", "drift east", "energy left", "room left"),
)  # and one for every agent

StateArray = NDArray[np.float32]


def state_space(setup: Setup) -> gymnasium.spaces.Box:
    """Space of `state_of`: values in [0, 1], (channel, row, column)."""
    shape = len(CHANNELS) + len(setup.fleet), *setup.graph.shape
    return gymnasium.spaces.Box(0.0, 1.0, shape, np.float32)


def state_of(mission: Mission, episode: int = 0) -> StateArray:
    """(channel, row, column) float32 in [0, 1] of one episode, in new memory; land is 0.

    | channel | meaning | unit | value |
    |---|---|---|---|
    | 0 | water | - | 1 |
    | 1 | idleness I by all scans, whichever agents received them | 1 | I |
    | 2 | believed items at the node, likewise | item | 0.1 each, at most 1 |
    | 3 | true items at the node | item | 0.1 each, at most 1 |
    | 4 | decisions taken so far, in every node | horizon | the share |
    | 5, 6 | drift d south and east of an item there | node/step | (1 + d) / 2, cut off |
    | 7 | energy left of the agent that is there | full store | the share; 1 without a limit |
    | 8 | room left of the agent that is there | full store | likewise |
    | 9 on | an agent each, in the fleet's order | - | 1 where it is |

    Where several agents are in one node, channels 7 and 8 have the largest share.
    """
    setup, truth, known = mission.setup, mission.truth, mission.knowledge
    graph, nodes = setup.graph, len(setup.graph)
    present = truth.item_node[episode]
    items = np.bincount(present[present >= 0], minlength=nodes)
    levels = np.zeros((len(CHANNELS) + len(setup.fleet), nodes), np.float32)
    levels[0] = 1.0
    levels[1] = mission.idleness(np.array([episode]))[0]
    levels[2] = np.clip(known.belief[episode] / MOST_ITEMS, 0.0, 1.0)
    levels[3] = np.minimum(items / MOST_ITEMS, 1.0)
    levels[4] = mission.step[episode] / setup.scenario.horizon
    levels[5:7] = np.clip(0.5 + 0.5 * mission.node_drift_rc[episode], 0.0, 1.0).T
    at = mission.state.agent_node[episode]
    np.maximum.at(levels[7], at, _energy_shares(mission, episode))
    np.maximum.at(levels[8], at, _room_shares(mission, episode))
    levels[len(CHANNELS) + np.arange(at.size), at] = 1.0
    picture = np.zeros((len(levels), *graph.shape), np.float32)
    picture[:, graph.rows, graph.cols] = levels
    return picture


def _energy_shares(mission: Mission, episode: int) -> NDArray[np.float64]:
    """(agent,) of the full store that is left."""
    full, left = mission.setup.fleet.energy, mission.energy_left[episode]
    ends = np.isfinite(full)
    return np.where(ends, left / np.where(ends, full, 1.0), 1.0)


def _room_shares(mission: Mission, episode: int) -> NDArray[np.float64]:
    """(agent,) of the full room that is left; it can be overdrawn by what lies in one node."""
    full, left = mission.setup.fleet.capacity, mission.room_left[episode]
    return np.where(full < UNLIMITED, np.clip(left / full, 0.0, 1.0), 1.0)
