"""Crews of two scouts and two foragers on the comb port: arrivals, contacts and their speeds.

The long runs are `python -m tests.controllers.proving_ground` and `touching_ground`.
"""

import pytest

from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.physics.vessels import load_vessel
from tests.controllers.touching_ground import PLACES, walked
from tests.controllers.walks import Outcome, Walk, comb_port, crew
from tests.graph_planner.charts import grid

HARD_MPS = 0.3
PERIODS = 12


def checked(outcome: Outcome, share: float) -> None:
    assert outcome.speeds.max(initial=0.0) <= HARD_MPS
    assert outcome.arrived.sum() >= share * outcome.moves.sum()


def test_random_walks() -> None:
    walk = Walk(comb_port(), crew(), episodes=20)
    checked(walk.run(PERIODS), 0.99)


def test_crowds() -> None:
    walk = Walk(comb_port(), crew(), episodes=20)
    checked(walk.run(PERIODS, crowded=True), 0.97)


def test_crowds_with_noisy_measurements() -> None:
    walk = Walk(comb_port(), crew(), episodes=10, noise=(0.3, 0.035), seed=1)
    checked(walk.run(PERIODS, crowded=True), 0.95)


def test_ideal_crews_are_never_late() -> None:
    ideal = load_vessel("ideal")
    outcome = Walk(comb_port(), [ideal] * 4, episodes=20).run(PERIODS, crowded=True)
    assert not outcome.late
    assert not outcome.impacts


@pytest.mark.parametrize("name", ["scout", "forager"])
def test_two_meet_in_a_corridor_of_one_cell(name: str) -> None:
    """Head-on, they pass each other or one waits: no hard contact, and nobody sails through."""
    graph = navigation_graph(grid("........"), 4.0, False)
    vessel = load_vessel(name)
    walk = Walk(graph, [vessel, vessel], [(0, 2), (0, 5)], scouts=0, episodes=12, seed=3)
    outcome = walk.run(15, crowded=True)
    assert outcome.speeds.max(initial=0.0) <= HARD_MPS
    assert outcome.arrived.sum() > 0.5 * outcome.moves.sum()


@pytest.mark.parametrize("name", ["four in a lane", "eight", "sixteen"])
def test_crowds_where_it_is_hard_not_to_touch(name: str) -> None:
    """Turning side by side, in contact, picking up at quays: they touch, and none fast."""
    speeds = walked(PLACES[name], episodes=6, periods=12, seed=2).speeds
    assert speeds.size > 20
    assert speeds.max() < 0.27
