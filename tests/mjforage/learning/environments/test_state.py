"""State for central critics: the map of all looks, and the truth."""

import numpy as np
import pytest

import mjforage
from mjforage.base.errors import UserError
from mjforage.learning.environments.state import CHANNELS, StateArray
from mjforage.mission.mission import Mission

LINK = ("link.model=disk", "link.range_m=32")
STORES = ("horizon=20", "team.foragers.capacity=4", "team.scouts.energy=10")


def by_hand(mission: Mission) -> StateArray:
    """The table of `state_of`, node by node."""
    graph, state, known = mission.setup.graph, mission.state, mission.knowledge
    agents, step = mission.setup.fleet.names, int(mission.step[0])
    expected = np.zeros((len(CHANNELS) + len(agents), *graph.shape), np.float32)
    for node, place in enumerate(zip(graph.rows, graph.cols, strict=True)):
        here = (slice(None), *place)
        age = step - int(known.last_seen[0, node])
        down, right = mission.initial.drift_rc[0]
        expected[here][:7] = [
            1.0,
            min(1.0, age / (0.9 * 20)),
            min(10, known.belief[0, node]) / 10,
            min(10, (state.item_node[0] == node).sum()) / 10,
            step / 20,
            (1 + down) / 2,
            (1 + right) / 2,
        ]
        for a, name in enumerate(agents):
            if state.agent_node[0, a] == node:
                scout = name.startswith("scouts")
                taken = (state.collected_by[0] == a).sum()
                expected[here][7] = (10 - state.distance[0, a]) / 10 if scout else 1.0
                expected[here][8] = 1.0 if scout else (4 - taken) / 4
                expected[here][9 + a] = 1.0
    return expected


def test_the_state_is_as_documented() -> None:
    env = mjforage.parallel_env(set=(*STORES, *LINK))
    seen, _ = env.reset(seed=2)
    rng, shown = np.random.default_rng(0), np.zeros(len(CHANNELS) + 4)
    while env.agents:
        state = env.state()
        assert env.state_space.contains(state)
        np.testing.assert_allclose(state, by_hand(env.core.mission), atol=1e-6)
        shown += [np.unique(channel).size for channel in state]
        legal = {a: np.flatnonzero(seen[a]["action_mask"]) for a in env.agents}
        seen, *_ = env.step({a: int(rng.choice(moves)) for a, moves in legal.items()})
    assert (shown >= 20).all()  # no channel is empty
    assert env.state_space.contains(env.state())  # a critic asks for the last one too


def test_the_state_is_of_all_looks_whatever_the_link() -> None:
    """And the truth is in it: items that nobody has seen."""
    states = []
    for link in ("link.model=ideal", "link.model=none"):
        env = mjforage.parallel_env(set=("horizon=20", link))
        env.reset(seed=1)
        for move in (0, 2, 4, 2):
            env.step(dict.fromkeys(env.agents, move))
        states.append(env.state())
    np.testing.assert_array_equal(states[0], states[1])
    belief, items = states[0][2], states[0][3]
    assert items.sum() > belief.sum()


def test_there_is_no_state_before_an_episode() -> None:
    with pytest.raises(UserError, match=r"state before the first reset: .*call reset first"):
        mjforage.parallel_env().state()
