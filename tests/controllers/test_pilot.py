"""The pilot as the mission sees it: shapes, ranges, reset, and no bit that depends on the batch."""

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.controllers import Chart, Pilot
from mjforage.physics.vessel_models import vessel_model
from mjforage.physics.vessels import load_vessel

VESSELS = [load_vessel(name) for name in ("scout", "forager")]
MODELS = [vessel_model(vessel) for vessel in VESSELS]
CHART = Chart(np.ones((6, 6), np.bool_), 4.0)
Commands = NDArray[np.float64]


def cases(episodes: int) -> dict[str, NDArray[np.float64]]:
    """Poses, velocities and orders of two vessels that get in each other's way, by episode."""
    rng = np.random.default_rng(0)
    pose = rng.uniform((6.0, 6.0, -3.0), (14.0, 14.0, 3.0), (episodes, 2, 3))
    return {
        "pose": pose,
        "velocity": rng.uniform(-0.3, 0.3, (episodes, 2, 3)),
        "target": np.rint(rng.uniform(1.0, 4.0, (episodes, 2, 2))) * 4.0,
        "origin": np.rint(pose[..., :2] / 4.0) * 4.0,
    }


def commands(pilot: Pilot, case: dict[str, NDArray[np.float64]], ticks: int = 25) -> Commands:
    """(tick, episode, vessel, 2) commands while the vessels move on at their speed."""
    n = case["pose"].shape[0]
    active = np.ones(n, np.bool_)
    pilot.order(active, case["origin"], case["target"], np.zeros((n, 2), np.bool_))
    rows = []
    for tick in range(ticks):
        pose = case["pose"] + 0.1 * tick * case["velocity"]
        rows.append(pilot.command(active, pose, case["velocity"]).copy())
    return np.array(rows)


def test_commands_are_in_range_and_not_all_the_same() -> None:
    found = commands(Pilot(MODELS, CHART, 40), cases(40))
    for v, model in enumerate(MODELS):
        assert model.command_low <= found[..., v, :].min() < -0.2 * model.command_high
        assert 0.5 * model.command_high < found[..., v, :].max() <= model.command_high


def test_an_episode_is_the_same_alone_and_in_any_batch() -> None:
    every = cases(40)
    together = commands(Pilot(MODELS, CHART, 40), every)
    for e in (0, 7, 39):
        alone = commands(Pilot(MODELS, CHART, 1), {k: a[e : e + 1] for k, a in every.items()})
        np.testing.assert_array_equal(alone[:, 0], together[:, e])
    back = commands(Pilot(MODELS, CHART, 40), {k: a[::-1] for k, a in every.items()})
    np.testing.assert_array_equal(back[:, ::-1], together)


def test_reset_forgets() -> None:
    pilot, case = Pilot(MODELS, CHART, 4), cases(4)
    first = commands(pilot, case)
    assert (commands(pilot, case) != first).any()
    pilot.reset(np.array([1, 3]))
    again = commands(pilot, case)
    np.testing.assert_array_equal(again[:, [1, 3]], first[:, [1, 3]])
    pilot.reset()
    np.testing.assert_array_equal(commands(pilot, case), first)


def test_inactive_episodes_get_nothing_and_keep_what_they_know() -> None:
    """An order for the first episode alone leaves the second at what it was told before."""
    pilots, case = [Pilot(MODELS, CHART, 2) for _ in range(2)], cases(2)
    for pilot in pilots:
        assert commands(pilot, case).any()
    first = np.array([True, False])
    stay = np.zeros((2, 2), np.bool_)
    pilots[0].order(first, case["target"], case["origin"], stay)
    still = pilots[0].command(first, case["pose"], case["velocity"])
    assert still[0].any() and not still[1].any()
    pilots[1].command(first, case["pose"], case["velocity"])
    told, old = (
        pilot.command(~first, case["pose"], case["velocity"])[1].copy() for pilot in pilots
    )
    assert old.any()
    np.testing.assert_array_equal(told, old)


def test_a_stay_at_the_place_needs_no_thrust() -> None:
    pilot, here = Pilot(MODELS, None, 1), np.array([[[0.0, 0.0], [8.0, 0.0]]])
    pilot.order(np.ones(1, np.bool_), here, here, np.ones((1, 2), np.bool_))
    pose = np.concatenate((here, np.zeros((1, 2, 1))), axis=2)
    assert not pilot.command(np.ones(1, np.bool_), pose, np.zeros((1, 2, 3))).any()


def test_before_the_first_order_nothing_moves() -> None:
    pilot, case = Pilot(MODELS, CHART, 3), cases(3)
    assert not pilot.command(np.ones(3, np.bool_), case["pose"], case["velocity"]).any()


def test_who_waits_gives_way() -> None:
    """Bow to bow at a metre, both told to go on: at least one is held back."""
    pilot, to = Pilot(MODELS[:1] * 2, None, 1), np.array([[[8.0, 0.0], [-8.0, 0.0]]])
    pose = np.array([[[-1.2, 0.0, 0.0], [1.2, 0.0, np.pi]]])
    active = np.ones(1, np.bool_)
    pilot.order(active, pose[..., :2].copy(), to, np.zeros((1, 2), np.bool_))
    pilot.command(active, pose, np.array([[[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]]))
    assert pilot.giving_way.any()


@pytest.mark.parametrize(("other", "gives_way"), [(1.4, True), (-1.4, False)])
def test_who_goes_ahead_gives_way_to_what_lies_ahead(other: float, gives_way: bool) -> None:
    pilot, active = Pilot(MODELS[:1] * 2, None, 1), np.ones(1, np.bool_)
    pose = np.array([[[0.0, 0.0, 0.0], [other, 0.0, 0.0]]])
    to = np.array([[[8.0, 0.0], [other, 0.0]]])
    pilot.order(active, pose[..., :2].copy(), to, np.array([[False, True]]))
    pilot.command(active, pose, np.array([[[0.5, 0.0, 0.0], [0.0, 0.0, 0.0]]]))
    assert pilot.giving_way.tolist() == [[gives_way, False]]


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_vessels_far_from_each_other_are_steered_each_as_if_alone(order: tuple[int, int]) -> None:
    """Under way, then kept by a quay to the north for half a minute, each by its own model."""
    water = np.ones((5, 60), np.bool_)
    water[0] = False
    chart, models = Chart(water, 4.0), [MODELS[v] for v in order]
    fleet, ones = Pilot(models, chart, 1), [Pilot([model], chart, 1) for model in models]
    begin, active = np.array([[[8.0, 8.0], [208.0, 8.0]]]), np.ones(1, np.bool_)
    to, stay = begin + np.array([8.0, 4.0]), np.zeros((1, 2), np.bool_)
    fleet.order(active, begin, to, stay)
    for v, one in enumerate(ones):
        one.order(active, begin[:, v : v + 1], to[:, v : v + 1], stay[:, :1])
    own = [VESSELS[v] for v in order]
    yaw, held = 0.4, np.zeros(2)
    wide = np.array([v.length_m * np.sin(yaw) + v.beam_m * np.cos(yaw) for v in own]) / 2.0
    for tick in range(300):
        pose = np.full((1, 2, 3), yaw)
        pose[..., 0] = begin[..., 0] + 0.06 * min(tick, 60)
        pose[..., 1] = np.minimum(8.0 + 0.1 * tick, 14.0 - wide)
        velocity = np.full((1, 2, 3), 0.0 if tick > 60 else 0.5)
        told = fleet.command(active, pose, velocity)
        for v, one in enumerate(ones):
            alone = one.command(active, pose[:, v : v + 1], velocity[:, v : v + 1])
            np.testing.assert_array_equal(alone[:, 0], told[:, v], f"tick {tick}, vessel {v}")
        held = np.maximum(held, fleet._fleets.state["held_s"][0])
    assert (held > 9.9).all()


@pytest.mark.parametrize("one", [0, 1])
def test_of_two_vessels_each_chooses_ways_and_items_by_its_own_model(one: int) -> None:
    """From random headings to nodes beside a quay, for items there, and put off them at the end."""
    rng, n = np.random.default_rng(2), 60
    water = np.ones((5, 60), np.bool_)
    water[0] = False
    fleet, alone = (
        Pilot(models, Chart(water, 4.0), n) for models in (MODELS, MODELS[one : one + 1])
    )
    begin = np.array([[8.0, 8.0], [208.0, 8.0]]) + np.zeros((n, 2, 2))
    to = begin + 4.0 * rng.integers(-1, 2, (n, 2, 2))
    item = np.where(rng.random((n, 2, 1)) < 0.5, to + rng.uniform(-1.8, 1.8, to.shape), np.nan)
    yaw, drift = rng.uniform(-3.0, 3.0, (n, 2)), rng.uniform(-0.2, 0.2, (n, 2, 2))
    active, stay, own = np.ones(n, np.bool_), (to == begin).all(axis=-1), slice(one, one + 1)
    fleet.order(active, begin, to, stay)
    alone.order(active, begin[:, own], to[:, own], stay[:, own])
    pose, velocity = np.zeros((n, 2, 3)), np.zeros((n, 2, 3))
    for tick in range(120):
        gone = min(tick / 60.0, 1.0) if tick < 90 else 0.4
        pose[..., :2], pose[..., 2] = begin + gone * (to - begin), yaw
        velocity[..., :2] = drift + (to - begin) / 6.0 * (tick < 60)
        fleet.collect(item)
        alone.collect(item[:, own])
        told = fleet.command(active, pose, velocity)
        np.testing.assert_array_equal(
            alone.command(active, pose[:, own], velocity[:, own]), told[:, own]
        )


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_each_vessel_aims_at_an_item_at_a_quay_until_its_own_bow_is_near(
    order: tuple[int, int],
) -> None:
    """1.85 m before one due north, set 0.5 m aside: the shorter scout aims anew."""
    water = np.ones((5, 60), np.bool_)
    water[0] = False
    pilot, active = Pilot([MODELS[v] for v in order], Chart(water, 4.0), 1), np.ones(1, np.bool_)
    item = np.array([[[8.0, 13.8], [208.0, 13.8]]])
    place = item - np.array([0.0, 1.85])
    pilot.order(active, place, place, np.ones((1, 2), np.bool_))
    pilot.collect(item)
    for aside in (0.0, 0.5):
        pose = np.full((1, 2, 3), 0.5 * np.pi)
        pose[..., :2] = place + np.array([aside, 0.0])
        for _ in range(20):
            pilot.command(active, pose, np.full((1, 2, 3), 0.1))
    turned = pilot._fleets.state["run"][0] - 0.5 * np.pi
    assert np.allclose(turned[np.array(order) == 1], 0.0)
    assert (turned[np.array(order) == 0] > 0.2).all()


def test_ways_are_planned_with_a_decision_and_twice_a_second_from_then_on() -> None:
    """Of each episode, which begins a decision amid those of another."""
    pilot, case = Pilot(MODELS, CHART, 2), {k: a[[1, 1]] for k, a in cases(2).items()}
    told, planned = [(0, [0, 1]), (3, [1])], []
    for tick in range(12):
        for begins, rows in told:
            if tick == begins:
                which = np.isin(np.arange(2), rows)
                pilot.order(which, case["origin"], case["target"], np.zeros((2, 2), np.bool_))
        for e in range(2):
            pilot._fleets.paths[:] = 0.0
            pilot.command(np.arange(2) == e, case["pose"], case["velocity"])
            if pilot._fleets.paths[:2].any():
                planned.append((tick, e))
    assert planned == [(0, 0), (0, 1), (3, 1), (5, 0), (8, 1), (10, 0)]


@pytest.mark.parametrize("leans", [0, 1])
def test_before_the_first_order_a_quay_that_holds_a_vessel_is_not_taken_for_still_water(
    leans: int,
) -> None:
    """Both drift north; then one lies at a quay, and the other is in water at rest."""
    water = np.ones((5, 60), np.bool_)
    water[0] = False
    pilot, active = Pilot(MODELS, Chart(water, 4.0), 1), np.ones(1, np.bool_)
    pose, velocity = np.zeros((1, 2, 3)), np.zeros((1, 2, 3))
    pose[..., 0], velocity[..., 1] = [[8.0, 208.0]], 0.2
    for tick in range(150):
        pose[..., 1] = 5.0 + 0.02 * tick
        pilot.command(active, pose, velocity)
    np.testing.assert_allclose(pilot._fleets.state["drift_y"], 0.2, atol=0.02)
    velocity[:] = 0.0
    pose[0, leans, 1] = 14.0 - 0.5 * VESSELS[leans].beam_m
    for _ in range(200):
        pilot.command(active, pose, velocity)
    drift = pilot._fleets.state["drift_y"][0]
    assert drift[leans] > 0.15 and abs(drift[1 - leans]) < 0.02
