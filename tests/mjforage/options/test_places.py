"""Neither an episode's place in a batch nor the order of the teams plays a part in decisions."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.graph_planner.policies import create_policy
from mjforage.mission.mission import Mission
from mjforage.mission.policy import UpperBound
from mjforage.mission.setup import Setup
from mjforage.mission.task import Observation
from mjforage.scenario.roles import Fleet
from mjforage.scenario.scenario_file import load_scenario
from tests.mjforage.options.scenes import overrides_of

EPISODES = np.array([4, 0, 7])
PLANNERS = ("belief", "oracle")
OTHERS = ("auction", "dec-mcts(simulations=8)", "greedy", "lawnmower", "levy", "pso", "wanderer")
STORES = ("team.scouts.energy=12", "team.foragers.energy=9", "team.foragers.capacity=5")


def mission(episodes: NDArray[np.int64]) -> Mission:
    setup = Setup.of(load_scenario("open-bay", overrides_of("small", "horizon=12", *STORES)))
    started = Mission(setup)
    started.reset(3, episodes)
    return started


@pytest.mark.parametrize("name", PLANNERS + OTHERS)
def test_an_episode_is_decided_alike_alone_and_in_a_batch(name: str) -> None:
    together, policy = mission(EPISODES), create_policy(name)
    alone = [mission(EPISODES[place : place + 1]) for place in range(EPISODES.size)]
    policies = [create_policy(name) for _ in alone]
    together.prepare(policy)
    for one, its in zip(alone, policies, strict=True):
        one.prepare(its)
    while together.active.any():
        answer = together.ask(policy).copy()
        for place in np.flatnonzero(together.active):
            own = alone[place].ask(policies[place])
            np.testing.assert_array_equal(own[0], answer[place], f"episode {EPISODES[place]}")
            alone[place].advance(own)
        together.advance(answer)


def in_order(seen: Observation, order: NDArray[np.int64]) -> Observation:
    """The same with the agents in another order."""
    names = ("agent_node", "energy_left", "room_left", "agent_seen", "taken", "pickup", "agent_yaw")
    return seen._replace(**{name: getattr(seen, name)[:, order] for name in names})


@pytest.mark.parametrize("name", PLANNERS)
def test_the_order_of_the_teams_plays_no_part(name: str) -> None:
    """Those policies draw nothing for each agent by its number."""
    play, one, other = mission(EPISODES), create_policy(name), create_policy(name)
    roles, order = play.setup.scenario.team, np.array([2, 3, 0, 1])
    play.prepare(one)
    other.reset(replace(play.task, fleet=Fleet.of(dict(reversed(list(roles.items()))))), play.keys)
    while play.active.any():
        if isinstance(other, UpperBound):
            other.set_ground_truth(play.truth)
        answer, going = play.ask(one).copy(), play.active
        turned = other.act(in_order(play.owner_observation, order))[:, order]
        np.testing.assert_array_equal(turned[going], answer[going], str(play.step))
        play.advance(answer)
