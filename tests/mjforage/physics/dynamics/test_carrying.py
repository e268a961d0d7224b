"""Drift that bounds and critics receive is the velocity of items."""

import numpy as np
import pytest

import mjforage
from mjforage.forcing import LEEWAY, Forcing
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.scenario.debris import load_debris
from mjforage.scenario.scenario import Weather
from mjforage.scenario.scenario_file import load_scenario

CLASSES = 'physics.item_classes=["drifter", "bottle", "bag"]'
STILL = ("weather.noise_node_per_step=0", "team.scouts.count=0", "horizon=8")
STREAM = ("weather.current_speed_mps=0.2", "weather.current_to_deg=60.0")
GYRE = ("weather.circulation_mps=0.1",)


def mission_of(*overrides: str, world: str = "physics", preset: str = "open-bay") -> Mission:
    mission = create_mission(Setup.of(load_scenario(preset, [*STILL, *overrides])), world)
    mission.reset(2, np.arange(3))
    return mission


@pytest.mark.parametrize("water", [STREAM, GYRE, ()])
def test_items_go_as_bounds_are_told(water: tuple[str, ...]) -> None:
    """Nobody near and no quay: by the mean of what is told before and after, each class of its own
    share of the wind.
    """
    mission, policy = (
        mission_of(*water, CLASSES, "items.covariance_node2=4"),
        create_policy("random"),
    )
    mission.prepare(policy)
    for _ in range(3):
        mission.advance(mission.ask(policy))  # let them come up to their speed
    before, at = mission.truth, mission.state.item_rc.copy()
    told = before.item_drift_rc.copy()
    mission.advance(mission.ask(policy))
    after = mission.truth
    left = (after.item_node >= 0) & (before.item_node >= 0)
    expected = 0.5 * (told + after.item_drift_rc)
    off = np.abs(mission.state.item_rc - at - expected).max(axis=-1)[left]
    assert np.median(off) < 0.01
    assert (off < 0.05).mean() > 0.8  # the others lie against a quay, or a vessel
    mean = [told[e][left[e]].mean(axis=0) for e in range(3)]
    np.testing.assert_allclose(before.drift_rc, mean, atol=1e-9)
    by_wind = np.abs(told - mission.initial.drift_rc[:, None]).max(axis=-1)[left]
    assert by_wind.max() > (0.1 if water else 0.02)


def test_the_share_of_the_wind_is_that_of_the_class() -> None:
    mission = mission_of(CLASSES)
    kinds, wind = load_debris(), mission.initial.drift_rc
    classes = mission._dynamics._simulation.item_class  # type: ignore[attr-defined]
    drift = mission.truth.item_drift_rc
    for name in ("drifter", "bottle", "bag"):
        number, kind = next((i, k) for i, k in enumerate(kinds) if k.name == name)
        for e, k in np.argwhere(classes == number)[:20]:
            np.testing.assert_allclose(drift[e, k], wind[e] * kind.leeway / LEEWAY, rtol=1e-5)


def test_water_carries_what_the_wind_does_not() -> None:
    """In a uniform current of 0.2 m/s to 30 degrees, in closed form: 4 m a node, 10 s a step."""
    graph = navigation_graph(np.ones((5, 5), np.bool_), 4.0, False)
    weather = Weather(0.8, 200.0, current_speed_mps=0.2, current_to_deg=60.0)
    forcing = Forcing.create(weather, np.zeros(1, np.uint64), graph, 10.0)
    leeway = np.array([[0.0, LEEWAY, 0.2, 1.0]])
    found, wind = forcing.carried_rc(0.0, np.full((1, 4, 2), 2.0), leeway), forcing.drift_rc
    current = 0.2 * 10.0 / 4.0 * np.array([-0.5, np.sqrt(0.75)])
    for share, velocity in zip(leeway[0], found[0], strict=True):
        closed = share / LEEWAY * wind[0] + (1.0 - share) * current
        np.testing.assert_allclose(velocity, closed, rtol=1e-5, atol=1e-12)


def test_without_lee_and_current_the_paper_s_items_drift_as_in_the_graph_to_the_bit() -> None:
    found = {world: mission_of(world=world).truth for world in ("graph", "hulls", "physics")}
    for truth in found.values():
        np.testing.assert_array_equal(truth.drift_rc, found["graph"].drift_rc)
        np.testing.assert_array_equal(truth.item_drift_rc, found["graph"].item_drift_rc)


def test_in_the_lee_of_land_items_drift_slower() -> None:
    open_, behind = (
        mission_of(f"weather.shelter_height_m={height}", preset="comb-port").node_drift_rc
        for height in (0, 3)
    )
    share = np.linalg.norm(behind, axis=-1) / np.linalg.norm(open_, axis=-1)
    assert share.min() == 0.0 and share.max() <= 1.0 + 1e-12 and 0.1 < share.mean() < 0.9


def test_the_state_shows_the_drift_of_every_node() -> None:
    """As `state_of` documents: 5 and 6 are drift south and east, (1 + d) / 2."""
    env = mjforage.parallel_env(scenario="channels", world="physics", set=("horizon=5", *GYRE))
    env.reset(seed=3)
    graph, drift = env.core.setup.graph, env.core.mission.node_drift_rc[0]
    shown = env.state()[5:7][:, graph.rows, graph.cols]
    np.testing.assert_allclose(shown, (0.5 + 0.5 * drift).T, atol=1e-6)
    assert np.ptp(drift, axis=0).min() > 0.1, "a gyre goes both ways"


FORCED = "weather.drift=forced"
WESTERLY = ("weather.wind_speed_mps=6", "weather.wind_from_deg=270")


@pytest.mark.parametrize("world", ["graph", "hulls", "physics"])
def test_a_wind_from_the_west_carries_items_east_each_by_its_leeway(world: str) -> None:
    mission = mission_of(FORCED, *WESTERLY, CLASSES, "items.covariance_node2=1", world=world)
    start, policy = mission.state.item_rc.copy(), create_policy("random")
    mission.prepare(policy)
    for _ in range(2):
        mission.advance(mission.ask(policy))
    there = mission.state.item_node >= 0
    went = (mission.state.item_rc - start)[there] * 4.0 / 20.0  # [m/s]
    kinds = {kind.name: kind.leeway for kind in load_debris()}
    each = np.array([kinds[name] for name in ("drifter", "bottle", "bag")])
    off = np.abs(went[:, 1:] / 6.0 - each) / each
    assert np.median(off.min(axis=1)) < 0.03 and np.median(np.abs(went[:, 0])) < 0.01
    assert np.unique(off.argmin(axis=1)).size == 3


@pytest.mark.parametrize("water", [STREAM, GYRE])
def test_forced_items_drift_alike_in_the_graph_and_in_mujoco(water: tuple[str, ...]) -> None:
    """The way of half of them within 3 %, from when they have come up to their speed."""
    ways = []
    for world in ("graph", "physics"):
        mission = mission_of(FORCED, *WESTERLY, *water, CLASSES, world=world)
        told, policy = [], create_policy("random")
        mission.prepare(policy)
        mission.advance(mission.ask(policy))
        start = mission.state.item_rc.copy()
        for _ in range(6):
            told.append(mission.truth.item_drift_rc.copy())
            mission.advance(mission.ask(policy))
        ways.append((mission.state.item_rc - start, mission.state.item_node >= 0, sum(told)))
    left = ways[0][1] & ways[1][1]
    graph, hulls = (np.median(way[left], axis=0) for way, *_ in ways)
    assert np.linalg.norm(graph - hulls) < 0.03 * np.linalg.norm(hulls)
    off = np.abs(ways[0][0] - ways[0][2]).max(axis=-1)[left]
    assert np.median(off) < 0.02 * np.linalg.norm(graph), "bounds are told what happens"


def test_forced_items_stay_in_the_lee_and_constant_ones_do_not() -> None:
    lee = ("weather.shelter_height_m=30", *WESTERLY)
    forced, constant = (
        mission_of(*more, *lee, world="graph", preset="comb-port").node_drift_rc
        for more in ((FORCED,), ())
    )
    assert (np.abs(forced).max(axis=-1) == 0.0).any() and (constant[..., 1] > 0.4).all()
