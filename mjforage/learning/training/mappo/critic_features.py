"""Features of the central critic beside the agents' observations: true items, and drift.

For training alone: no agent and no shipped network reads it.
"""

import numpy as np
from numpy.typing import NDArray

from mjforage.graph_planner.encodings.chart import COARSE
from mjforage.graph_planner.encodings.encoder import MOST_ITEMS, TOP
from mjforage.learning.environments.core import EnvironmentCore
from mjforage.learning.training.rounds import Round
from mjforage.mission.mission import Mission

CRITIC_FEATURES = {"truth.items": (1, COARSE, COARSE), "truth.facts": (5,)}
"""Arrays of an episode, uint8 levels: items that are left in each of the map's coarse cells; shares
of items left, of items left but found, of decisions taken, and mean drift of the items left, south
and east."""


def critic_features(played: Round) -> dict[str, NDArray[np.uint8]]:
    """Arrays (env, ...) of `CRITIC_FEATURES` of all episodes of a round, as they are now."""
    out = {n: np.zeros((played.num_envs, *s), np.uint8) for n, s in CRITIC_FEATURES.items()}
    for core, envs in zip(played.cores, played.envs, strict=True):
        core.come_back(maps=False)
        out["truth.items"][envs, 0] = _items(core.mission)
        out["truth.facts"][envs] = _facts(core)
    return out


def _items(mission: Mission) -> NDArray[np.uint8]:
    """(env, COARSE, COARSE) items left in each cell."""
    graph, at = mission.setup.graph, mission.truth.item_node
    height, width = graph.shape
    cell = (graph.rows * COARSE // height) * COARSE + graph.cols * COARSE // width
    counts = np.zeros((len(at), COARSE**2), np.int64)
    env, item = np.nonzero(at >= 0)
    np.add.at(counts, (env, cell[at[env, item]]), 1)
    levels = np.minimum(counts, MOST_ITEMS) * TOP // MOST_ITEMS
    return np.asarray(levels.reshape(-1, COARSE, COARSE), np.uint8)


def _facts(core: EnvironmentCore) -> NDArray[np.uint8]:
    """(env, 5) the last array of `CRITIC_FEATURES`."""
    mission = core.mission
    left = (mission.truth.item_node >= 0).sum(axis=1)
    found = (mission.ledger.t_discovered >= 0).sum(axis=1)
    gone = (mission.ledger.t_collected >= 0).sum(axis=1)
    drift = np.clip(0.5 + 0.5 * mission.truth.drift_rc, 0.0, 1.0)
    columns = (
        left / core.n_items,
        (found - gone) / core.n_items,
        mission.step / core.setup.scenario.horizon,
        drift[:, 0],
        drift[:, 1],
    )
    shares = np.clip(np.stack(columns, axis=1), 0.0, 1.0)
    levels: NDArray[np.uint8] = (TOP * shares).astype(np.uint8)
    return levels
