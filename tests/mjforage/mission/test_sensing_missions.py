"""Missions with imperfect scans: the same beside whatever else is played, and blind to what nobody
has detected. `test_plain_mission` says what they see.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.initial_state import InitialState
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario_file import load_scenario

SENSORS = (
    *("sensors.detection=0.7", "sensors.half_range_node=3", "sensors.persistence=0.2"),
    *(
        "sensors.false_rate=0.002",
        "sensors.false_hold=3",
        "sensors.merge=0.2",
        "sensors.fov_deg=200",
    ),
    *("prior.detection=0.7", "prior.half_range_node=3", "prior.false_rate=0.002"),
)
DISK = ("link.model=disk",)


def setup_of(*overrides: str) -> Setup:
    return Setup.of(load_scenario("comb-port", ["horizon=40", *overrides]))


def played(setup: Setup, policy: str, episodes: tuple[int, ...] = (0, 1, 2)) -> dict[str, Any]:
    """What a batch comes to."""
    mission = Mission(setup)
    mission.reset(5, np.array(episodes))
    mission.run(create_policy(policy))
    entries, state = mission.ledger, mission.state
    return {
        "agent_node": state.agent_node.copy(),
        "distance": state.distance.copy(),
        "discovered": entries.t_discovered.copy(),
        "collected": entries.t_collected.copy(),
        "belief": mission.knowledge.belief.copy(),
    }


class Thinned(Setup):
    """A setup in which some items do not exist."""

    gone: NDArray[np.bool_]  # (episode, item)

    def create_initial_state(self, keys: UInt64Array) -> InitialState:
        initial = super().create_initial_state(keys)
        return replace(initial, item_node=np.where(self.gone, -1, initial.item_node))


@pytest.mark.parametrize("policy", ["greedy", "belief"])
def test_items_that_nobody_has_detected_change_nothing(policy: str) -> None:
    setup = setup_of("sensors.detection=0.1", "prior.detection=0.1")
    whole = played(setup, policy)
    unseen = whole["discovered"] < 0
    assert unseen.any() and not unseen.all()
    thinned = Thinned(setup.scenario, setup.grid)
    object.__setattr__(thinned, "gone", unseen)
    less = played(thinned, policy)
    for name in ("agent_node", "distance", "discovered", "collected", "belief"):
        np.testing.assert_array_equal(less[name], whole[name], err_msg=name)


def test_what_is_in_view_in_an_episode_is_told_of_it_alone() -> None:
    mission, everybody = Mission(setup_of(*SENSORS)), np.arange(4)
    mission.reset(5, np.arange(3))
    whole = mission.times_seen(everybody, np.arange(3))
    for e in range(3):
        alone = mission.times_seen(everybody, np.array([e]))
        np.testing.assert_array_equal(alone[0], whole[e])


def test_hulls_scan_with_the_same_sensors() -> None:
    """At step 0 hulls lie as agents stand, so both worlds show the same."""
    known = []
    for world in ("graph", "physics"):
        mission = create_mission(setup_of(*SENSORS), world)
        mission.reset(5, np.arange(3))
        knowledge = mission.knowledge
        known.append((knowledge.belief.copy(), knowledge.last_seen.copy()))
    np.testing.assert_array_equal(known[0][0], known[1][0])
    np.testing.assert_array_equal(known[0][1], known[1][1])
    whole = Mission(setup_of())
    whole.reset(5, np.arange(3))
    assert (known[0][1] == 0).sum() < (whole.knowledge.last_seen == 0).sum(), "200 degrees"
