"""The tree, the distributions over plans, and what plans are worth, against plain numpy."""

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.randomness import bits, mix, to_uniform
from mjforage.graph_planner.belief_planner.routes import Legs
from mjforage.graph_planner.belief_planner.sweeps import Cover
from mjforage.graph_planner.dec_mcts.foraging import plan_turn, search_tours
from mjforage.graph_planner.dec_mcts.plans import (
    Plans,
    drawn_plan,
    likeliest,
    plans_of,
    shift_chances,
    take_candidates,
)
from mjforage.graph_planner.dec_mcts.search import TreeOptions, begin
from mjforage.graph_planner.dec_mcts.sights import (
    Scouts,
    faded,
    sample_sights,
    sights_of,
    sweep_value,
)
from mjforage.graph_planner.dec_mcts.tours import claims_of, gain_of, sample_claims, tour_value
from mjforage.graph_planner.dec_mcts.tree import back_up, step_down, tree_of

GAMMA, KEY = 0.9, np.uint64(77)
EFFORT = TreeOptions(4, 60, 6, 6, GAMMA, GAMMA, 0.3, 0.99, 0.1, 0.6, 0.3, 0.5, 8, 20.0)
ALL = np.ones(2)


def on_a_line(foragers: list[float], stops: list[float], weight: list[float], room: float) -> Legs:
    at, there = np.array(foragers), np.array(stops)
    return Legs(
        np.array(weight),
        np.abs(at[:, None] - there),
        np.abs(there[:, None] - there)[None],
        np.zeros(at.size, np.int64),
        np.full(at.size, room),
        np.full(at.size, 1e3),
    )


def sure(plans: Plans, agent: int, steps: list[int]) -> None:
    """Let an agent have one plan."""
    plans.number[agent], plans.length[agent, 0] = 1, len(steps)
    plans.step[agent, 0, : len(steps)], plans.chance[agent, 0] = steps, 1.0


def test_draws_are_a_sequence_of_their_key() -> None:
    from mjforage.graph_planner.dec_mcts import search

    state = begin(KEY, 3, 5)
    assert state[0] == bits(KEY, 3, 5)
    start = int(state[0])
    for i in (1, 2):
        expected = (start + i * 0x9E3779B97F4A7C15) % 2**64
        assert search.draw(state) == to_uniform(mix(np.uint64(expected)))


def test_bounds_of_children_are_discounted() -> None:
    tree, forget, explore = tree_of(10, 3), 0.8, 0.3
    for now, (action, utility) in enumerate([(4, 1.0), (4, 0.0), (2, 0.6)]):
        path = [0, 0]
        path[1], added = step_down(tree, 0, action, now, explore, forget)
        assert added == (now in (0, 2))
        back_up(tree, np.array(path), np.array([action], np.int32), utility, now, forget)
    np.testing.assert_allclose(tree.visits[:3], [2.44, 1.8, 1.0])
    np.testing.assert_allclose(tree.total[1:3], [0.8, 0.6])
    counts, parents = np.array([1.8 * 0.64, 0.8]), 2.44 * 0.8
    bounds = np.array([0.8 / 1.8, 0.6]) + explore * np.sqrt(np.log(parents) / counts)
    node, added = step_down(tree, 0, 4, 3, explore, forget)
    assert not added and node == 1 + int(np.argmax(bounds)) == 2


def test_little_tried_children_are_tried_again() -> None:
    """Bounds of 0.5 + 0.3 R sqrt(ln 10 / 9) and 0.4 + 0.3 R sqrt(ln 10) are equal at R = 0.33."""
    for spread, expected in ((0.2, 1), (0.5, 2)):
        tree = tree_of(10, 3)
        step_down(tree, 0, 7, 0, 0.3, 1.0)
        tree.visits[:2], tree.total[1] = 9.0, 4.5
        step_down(tree, 0, 8, 0, 0.3, 1.0)
        tree.visits[0], tree.visits[2], tree.total[2] = 10.0, 1.0, 0.4
        tree.bounds[:] = 0.0, spread
        assert step_down(tree, 0, 8, 0, 0.3, 1.0)[0] == expected


def test_children_are_added_as_the_root_of_the_simulations() -> None:
    tree = tree_of(100, 1)
    for now in range(32):
        node, _ = step_down(tree, 0, now % 9, now, 0.5, 1.0)
        back_up(tree, np.array([0, node]), np.zeros(1, np.int32), 0.1, now, 1.0)
        assert tree.size[0] - 1 <= np.ceil(np.sqrt(now + 1))
    assert tree.size[0] - 1 == 6


def test_one_step_of_the_gradient() -> None:
    chance, value = np.array([0.5, 0.3, 0.2]), np.array([1.0, 3.0, 2.0])
    mean, entropy = (chance * value).sum(), -(chance * np.log(chance)).sum()
    expected = chance + 0.2 * chance * ((value - mean) / 4.0 - entropy - np.log(chance))
    shift_chances(chance, value, 4.0, 0.2)
    np.testing.assert_allclose(chance, expected / expected.sum(), rtol=1e-12)


def test_cold_distributions_settle_on_the_best_and_warm_ones_stay_wide() -> None:
    value = np.array([1.0, 3.0, 2.0])
    for heat, least, most in ((0.3, 0.9, 1.0), (50.0, 0.3, 0.4)):
        chance = np.array([0.6, 0.2, 0.2])
        for _ in range(80):
            shift_chances(chance, value, heat, 0.2)
        assert np.argmax(chance) == 1 and least < chance[1] < most
        assert chance.sum() == pytest.approx(1.0)


def test_plans_are_drawn_by_their_chances() -> None:
    plans = plans_of(2, 3, 2)
    assert drawn_plan(plans, 1, 0.4) == -1
    plans.number[1], plans.chance[1] = 3, [0.2, 0.5, 0.3]
    assert [drawn_plan(plans, 1, u) for u in (0.0, 0.19, 0.21, 0.69, 0.71, 0.999)] == [
        *(0, 0, 1, 1, 2, 2)
    ]


def test_the_best_of_the_tree_join_the_likeliest_of_before() -> None:
    tree, plans = tree_of(10, 2), plans_of(1, 3, 2)
    plans.number[0], plans.length[0], plans.chance[0] = 2, 1, [0.25, 0.75, 0.0]
    plans.step[0, :2, 0] = 5, 6
    for now, (action, utility) in enumerate([(0, 0.2), (1, 0.9), (2, 0.5), (6, 0.95)]):
        node, _ = step_down(tree, 0, action, now, 0.0, 1.0)
        if tree.action[node] != action:  # not yet wide enough
            tree.visits[0] = 99.0
            node, _ = step_down(tree, 0, action, now, 0.0, 1.0)
        back_up(tree, np.array([0, node]), np.array([action], np.int32), utility, now, 1.0)
    take_candidates(plans, 0, tree)
    assert plans.step[0, : plans.number[0], 0].tolist() == [6, 1, 2]
    np.testing.assert_allclose(plans.chance[0], np.array([0.75, 1 / 3, 1 / 3]) / (0.75 + 2 / 3))
    assert likeliest(plans, 0).tolist() == [6]


def fleet_value(legs: Legs, tours: list[list[int]]) -> float:
    """Worth of all items, each by when the first comes for it, of tours that leave out nothing."""
    first = np.full(legs.weight.size, np.inf)
    for f, tour in enumerate(tours):
        clock, at = 0.0, -1
        for stop in tour:
            clock += legs.first[f, stop] if at < 0 else legs.between[0, at, stop]
            first[stop], at = min(first[stop], clock), stop
    return float((legs.weight * GAMMA**first).sum())


@pytest.mark.parametrize("mine", [[0, 1, 2, 3], [3, 2, 1, 0], [2, 0, 3, 1]])
@pytest.mark.parametrize("theirs", [[1], [2, 3], [3, 0, 1]])
def test_a_tour_is_worth_what_the_fleet_gains(mine: list[int], theirs: list[int]) -> None:
    legs = on_a_line([0.0, 9.0], [2.0, 4.0, 5.0, 8.0], [1.0, 2.0, 1.0, 3.0], 6.9)
    legs.room[0] = 99.0  # the other has no room left to come for the rest
    plans, claims = plans_of(2, 3, 4), claims_of(4)
    sure(plans, 1, theirs)
    sample_claims(EFFORT, legs, plans, 0, ALL, begin(KEY, 0, 0), claims)
    claims.later[:] = 0.0
    gain = fleet_value(legs, [mine, theirs]) - fleet_value(legs, [[], theirs])
    value = tour_value(EFFORT, legs, 0, np.array(mine, np.int32), claims)
    assert value == pytest.approx(gain)


def test_what_is_left_over_counts_by_who_could_be_there_first() -> None:
    legs = on_a_line([0.0, 9.0], [2.0, 4.0, 8.0], [1.0, 2.0, 3.0], 99.0)
    plans, claims = plans_of(2, 3, 3), claims_of(3)
    sample_claims(EFFORT, legs, plans, 0, ALL, begin(KEY, 0, 0), claims)
    value = tour_value(EFFORT, legs, 0, np.array([0], np.int32), claims)
    assert value == pytest.approx(GAMMA**2 + 2.0 * (GAMMA**4 - GAMMA**5))
    legs.room[0] = 1.0  # nothing more fits
    assert tour_value(EFFORT, legs, 0, np.array([0], np.int32), claims) == pytest.approx(GAMMA**2)


def test_what_does_not_fit_is_left_to_the_other() -> None:
    legs = on_a_line([0.0, 9.0], [3.0], [5.0], 2.0)
    plans, claims = plans_of(2, 3, 1), claims_of(1)
    sure(plans, 1, [0])
    sample_claims(EFFORT, legs, plans, 0, ALL, begin(KEY, 0, 0), claims)
    value = tour_value(EFFORT, legs, 0, np.zeros(1, np.int32), claims)
    assert value == pytest.approx(2.0 * GAMMA**3)  # and the other has its two as before
    assert not claims.later.any()  # the other is full then
    legs.weight[0] = 3.0
    value = tour_value(EFFORT, legs, 0, np.zeros(1, np.int32), claims)
    assert value == pytest.approx(2.0 * GAMMA**3 - GAMMA**6)  # one less for the other


def test_who_comes_later_takes_what_is_left() -> None:
    assert gain_of(0.8, 2.0, 5.0, 0.5, 2.0) == pytest.approx(2.0 * 0.5)
    assert gain_of(0.8, 2.0, 3.0, 0.5, 2.0) == pytest.approx(1.0 * 0.5)
    assert gain_of(0.8, 2.0, 2.0, 0.5, 2.0) == 0.0


def test_rollouts_go_by_decisions_per_item() -> None:
    legs = on_a_line([0.0], [1.0, -2.0], [1.0, 5.0], 99.0)
    effort = EFFORT._replace(rounds=1, simulations=1, roam=0.0)
    assert search_tours(effort, legs, ALL[:1], KEY, 1).tolist() == [1]


def test_mates_that_are_not_heard_of_are_not_counted_on() -> None:
    legs = on_a_line([0.0, 9.0], [3.0], [1.0], 2.0)
    plans, claims = plans_of(2, 3, 1), claims_of(1)
    sure(plans, 1, [0])
    state, met = begin(KEY, 0, 0), 0
    for _ in range(400):
        sample_claims(EFFORT, legs, plans, 0, np.array([1.0, 0.25]), state, claims)
        met += claims.worth[0] > 0.0
    assert 70 < met < 130


@pytest.mark.parametrize(
    ("heat", "cool", "turn", "settled"),
    [(1e-3, 1.0, 0, True), (1e3, 1.0, 1, False), (1e3, 1e-6, 0, False), (1e3, 1e-6, 1, True)],
)
def test_distributions_cool_from_round_to_round(
    heat: float, cool: float, turn: int, settled: bool
) -> None:
    legs = on_a_line([4.0], [0.0, 1.0, 8.0, 9.0], [1.0, 1.0, 1.0, 2.0], 99.0)
    plans, tree = plans_of(1, EFFORT.candidates, 4), tree_of(200, 4)
    effort = EFFORT._replace(heat=heat, cool=cool)
    plan_turn(effort, legs, 0, tree, plans, ALL[:1], turn, KEY, 1)
    assert plans.number[0] > 1
    assert (plans.chance[0].max() > 0.8) == settled


def test_a_view_takes_a_decision() -> None:
    fade = sights_of(1, 1, GAMMA).fade
    assert [faded(fade, d) for d in (0, 1, 2, 65535)] == [GAMMA, GAMMA, GAMMA**2, 0.0]


def test_tours_share_out_the_stops() -> None:
    legs = on_a_line([4.0, 5.0], [0.0, 1.0, 8.0, 9.0], [1.0, 1.0, 1.0, 1.0], 99.0)
    targets = search_tours(EFFORT, legs, ALL, KEY, 1)
    assert targets.tolist() == [1, 2]
    assert (search_tours(EFFORT, legs, ALL, KEY, 1) == targets).all()
    legs.room[0] = 0.0
    assert search_tours(EFFORT, legs, ALL, KEY, 1).tolist() == [-1, 2]


def corridor(scouts: list[int], mass: NDArray[np.float64]) -> Scouts:
    """Scouts in a row of cells, who move by one and see their own cell and those beside it."""
    n = mass.size
    ends = np.full((1, n, 9), -1, np.int32)
    ends[0, :-1, 2], ends[0, 1:, 6] = np.arange(1, n), np.arange(n - 1)
    lists = [[c for c in (v - 1, v, v + 1) if 0 <= c < n] for v in range(n)]
    start = np.concatenate(([0], np.cumsum([len(one) for one in lists])))
    nodes = np.arange(n)
    away = np.maximum(0, np.abs(nodes[:, None] - nodes) - 1).astype(np.uint16)
    landmark = np.where(nodes == 3, 0, nodes).astype(np.int32)  # cell 3 belongs to cell 0's
    nothing = np.zeros(0, np.int64), np.zeros(0, np.int32)
    cover = Cover(start, np.concatenate(lists).astype(np.int32), landmark, away, *nothing)
    at, kind = np.array(scouts, np.int32), np.zeros(len(scouts), np.int64)
    total: NDArray[np.float64] = np.bincount(landmark, mass, minlength=n).astype(np.float64)
    return Scouts(kind, at, ends, (cover,), mass, total)


def test_a_sweep_is_worth_what_the_fleet_sees_sooner() -> None:
    mass = np.array([1.0, 0.0, 2.0, 1.0, 3.0, 0.5, 4.0])
    scouts, plans, sights = corridor([1, 6], mass), plans_of(2, 2, 3), sights_of(7, 7, GAMMA)
    sure(plans, 1, [6, 6])  # sees 4 to 6 after one decision, 3 after two
    sample_sights(EFFORT, scouts, plans, 0, ALL, begin(KEY, 0, 0), sights)
    np.testing.assert_array_equal(sights.left, [1.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0])
    elsewhere = GAMMA ** (2 + 1)  # cell 2, one farther on; cell 0 is three farther on
    east, west = np.array([2, 2], np.int32), np.array([6], np.int32)
    gained = 2.0 * GAMMA + (GAMMA - GAMMA**2)  # cells 2 and 3; 4 is no sooner
    left = GAMMA**2 * GAMMA**2 - GAMMA ** (2 + 3)  # cell 0, seen again from 1
    assert sweep_value(EFFORT, scouts, 0, east, sights) == pytest.approx(gained + left)
    left = 2.0 * max(0.0, GAMMA * GAMMA - elsewhere)
    assert sweep_value(EFFORT, scouts, 0, west, sights) == pytest.approx(GAMMA + left)
