import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.controllers import Chart, Pilot
from mjforage.controllers.collecting import can_be_ready, collect_item, get_ready
from mjforage.controllers.quayside import is_quayed, line_to_item, note_quays
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Simulation
from mjforage.physics.vessel_models import vessel_model
from mjforage.physics.vessels import load_vessel
from tests.controllers.plant import FORAGER as P
from tests.controllers.plant import blank

FORAGER = load_vessel("forager")
BASIN, PITCH_M = np.ones((3, 3), np.bool_), 4.0
CENTRE = 4.0
ROOM_M = 0.5 * PITCH_M


def in_basin(episodes: int) -> tuple[Simulation, Pilot]:
    """Lone foragers in the basin, and their pilot."""
    scene = build_scene([FORAGER], navigable=BASIN, pitch_m=PITCH_M)
    pilot = Pilot([vessel_model(FORAGER)], Chart(BASIN, PITCH_M), episodes)
    return Simulation(scene, episodes), pilot


def pick(
    items: NDArray[np.float64],
    yaws: NDArray[np.float64],
    seconds: float,
    node: NDArray[np.float64] | None = None,
    origin: NDArray[np.float64] | None = None,
) -> tuple[NDArray[np.float64], float]:
    """Time at which each item passed the mouth [s], and the farthest midships from the node.

    `node` (episode, 1, 2) is the centre of each one's node, by default the basin's; `origin` that
    of the node from which it is ordered there, by default the same.
    """
    n = yaws.size
    simulation, pilot = in_basin(n)
    active, to = np.ones(n, np.bool_), np.full((n, 1, 2), CENTRE) if node is None else node
    begin = to if origin is None else origin
    pose = np.concatenate((begin, yaws[:, None, None]), axis=-1)
    simulation.place_vessels(pose)
    taken, ahead, farthest = np.full(n, np.inf), np.full(n, np.inf), 0.0
    for tick in range(round(10 * seconds)):
        if tick % 100 == 0:
            stay = np.full((n, 1), tick > 0 or origin is None)
            pilot.order(active, begin, to, stay)
        pilot.collect(np.where(np.isinf(taken)[:, None, None], items, np.nan))
        now, speed = simulation.vessel_pose, simulation.vessel_velocity
        simulation.commands[:] = pilot.command(active, now, speed)
        simulation.step()
        x, y, yaw = simulation.vessel_pose[:, 0].T
        dx, dy = items[:, 0, 0] - x, items[:, 0, 1] - y
        was, ahead = ahead, np.cos(yaw) * dx + np.sin(yaw) * dy
        aside = np.cos(yaw) * dy - np.sin(yaw) * dx
        bow, half = 0.5 * FORAGER.length_m, 0.5 * FORAGER.beam_m
        taken[(was > bow) & (ahead <= bow) & (np.abs(aside) < half) & np.isinf(taken)] = tick * 0.1
        farthest = max(farthest, np.abs([x - to[:, 0, 0], y - to[:, 0, 1]]).max())
    return taken, farthest


@pytest.mark.parametrize("side", [-0.4, 0.0, 0.4])
def test_an_item_ahead_goes_straight_into_the_mouth(side: float) -> None:
    taken, _ = pick(np.array([[[CENTRE + 1.8, CENTRE + side]]]), np.zeros(1), 6.0)
    assert taken[0] < 5.0


def test_items_anywhere_in_the_node_are_picked_up_without_leaving_it() -> None:
    rng = np.random.default_rng(0)
    items = CENTRE + rng.uniform(-1.9, 1.9, (60, 1, 2))
    taken, farthest = pick(items, rng.uniform(-np.pi, np.pi, 60), 20.0)
    assert np.mean(taken < 10.0) > 0.5
    assert np.mean(taken < 20.0) > 0.9
    assert farthest < ROOM_M + 0.3


def test_an_item_abeam_is_backed_off_from_before_turning() -> None:
    s = blank()
    s.item_x, s.item_y = 0.3, 0.9
    heading, speed = collect_item(s, P, 1.3, 0.1)
    assert (heading, speed < 0.0) == (0.0, True)


def test_an_item_in_the_next_node_is_taken_on_the_way() -> None:
    """Within a decision, where it lies less than 90 degrees off the bow."""
    rng = np.random.default_rng(3)
    angle = 0.25 * np.pi * rng.integers(0, 8, 40)
    way = np.round(np.column_stack((np.cos(angle), np.sin(angle))))[:, None]
    items = CENTRE + rng.uniform(-1.3, 1.3, (40, 1, 2))
    origin = CENTRE - PITCH_M * way
    dx, dy = (items - origin)[:, 0].T
    yaws = np.arctan2(dy, dx) + np.radians(rng.uniform(-85, 85, 40))
    taken, _ = pick(items, yaws, 10.0, np.full((40, 1, 2), CENTRE), origin)
    assert np.mean(taken < 10.0) > 0.95


def ready(
    items: NDArray[np.float64], yaws: NDArray[np.float64], *seconds: float
) -> NDArray[np.float64]:
    """Poses (vessel, 3) of vessels that keep to the basin's middle and expect items (vessel, 1, 2).

    They are told to stay once for each of the times [s].
    """
    n = yaws.size
    simulation, pilot = in_basin(n)
    active, to = np.ones(n, np.bool_), np.full((n, 1, 2), CENTRE)
    simulation.place_vessels(np.concatenate((to, yaws[:, None, None]), axis=-1))
    pilot.expect(items)
    for stay in seconds:
        pilot.order(active, to, to, np.ones((n, 1), np.bool_))
        for _ in range(round(10 * stay)):
            now, speed = simulation.vessel_pose, simulation.vessel_velocity
            simulation.commands[:] = pilot.command(active, now, speed)
            simulation.step()
    return np.asarray(simulation.vessel_pose[:, 0])


@pytest.mark.parametrize("seconds", [(16.0,), (16.0, 4.0)])
def test_a_vessel_with_nothing_to_do_waits_at_the_rim_of_its_node_facing_the_next_item(
    seconds: tuple[float, ...],
) -> None:
    """Also if it is told again to stay: it does not go back to the middle first."""
    rng = np.random.default_rng(4)
    angle, yaws = rng.uniform(-np.pi, np.pi, 40), rng.uniform(-np.pi, np.pi, 40)
    items = CENTRE + 5.0 * np.column_stack((np.cos(angle), np.sin(angle)))[:, None]
    x, y, yaw = ready(items, yaws, *seconds).T
    off = np.arctan2(items[:, 0, 1] - y, items[:, 0, 0] - x) - yaw
    assert np.abs((off + np.pi) % (2.0 * np.pi) - np.pi).max() < np.radians(10.0)
    off_place = np.hypot(x - CENTRE, y - CENTRE)
    assert off_place.min() > 1.0 and off_place.max() < 1.5


def test_in_a_drift_a_vessel_keeps_its_place_and_does_not_turn_to_the_next_item() -> None:
    """It has no thrust aside: facing the item it would be carried out of its node."""
    for name, value, ready in (
        ("drift_y", 0.09, True),
        ("drift_y", 0.11, False),
        ("up", 0.5, False),
        ("looks", 1.0, False),
        ("arrived", 0.0, False),
        ("place_x", 1.0, False),
    ):
        s = blank()
        s.arrived, s.next_x, s.next_y = 1.0, 5.0, 0.0
        setattr(s, name, value)
        assert can_be_ready(s) == ready


def test_an_item_within_the_reach_of_the_turning_bow_is_not_turned_to() -> None:
    s = blank()
    s.yaw, s.next_x, s.next_y = 0.2, 0.3, 0.9
    assert get_ready(s, P, 1.3) == (0.2, 0.0)


REST_M = 5.9  # from the basin's middle, of an item's middle that touches a quay: 6 m less 0.1


def test_items_in_the_corner_of_a_basin_are_taken() -> None:
    """A full-beam mouth does not fit into a corner at 45 degrees, along the quay it does."""
    rng = np.random.default_rng(1)
    sides = rng.choice((-1.0, 1.0), (24, 1, 2))
    items = CENTRE + sides * REST_M
    corner = CENTRE + PITCH_M * sides
    taken, _ = pick(items, rng.uniform(-np.pi, np.pi, 24), 30.0, corner)
    assert np.isfinite(taken).all()


def test_items_along_a_straight_quay_are_taken() -> None:
    """Square on: a bow that comes in obliquely touches the quay with a corner first."""
    rng = np.random.default_rng(2)
    side, along = rng.choice((-1.0, 1.0), 40), rng.uniform(-1.3, 1.3, 40)
    across, turned = side * rng.uniform(REST_M - 0.1, REST_M, 40), rng.random(40) < 0.5
    item, node = np.column_stack((across, along)), np.column_stack((PITCH_M * side, 0.0 * side))
    for offset in (item, node):
        offset[turned] = offset[turned, ::-1]
    items, node = CENTRE + item[:, None], CENTRE + node
    taken, _ = pick(items, rng.uniform(-np.pi, np.pi, 40), 30.0, node[:, None])
    assert np.mean(np.isfinite(taken)) > 0.95


@pytest.mark.parametrize("east", [1.0, -1.0])
@pytest.mark.parametrize("north", [1.0, -1.0])
@pytest.mark.parametrize("yaw", [0.0, 0.5 * np.pi, np.pi, -0.5 * np.pi])
def test_a_corner_is_entered_along_the_quay_nearer_ahead(
    east: float, north: float, yaw: float
) -> None:
    """On the line the near edge of the mouth reaches past the item, towards the other quay."""
    s, model, land = blank(), P, Chart(BASIN, PITCH_M).land
    s.x, s.y, s.yaw = CENTRE + 4 * east, CENTRE + 4 * north, yaw
    s.item_x, s.item_y = CENTRE + REST_M * east, CENTRE + REST_M * north
    note_quays(s, model, land, PITCH_M)
    assert (s.quay_x, s.quay_y) == (east, north)
    run = np.array([np.cos(s.run), np.sin(s.run)])
    quays = np.array([[east, 0.0], [0.0, north]])
    assert np.abs(quays - run).sum(axis=1).min() == pytest.approx(0.0, abs=1e-9)
    assert run @ [np.cos(yaw), np.sin(yaw)] > -1e-9
    other = quays[np.abs(quays - run).sum(axis=1).argmax()]
    inside = 0.5 * FORAGER.beam_m - 0.05
    s.x, s.y = np.array([s.item_x, s.item_y]) - 2.0 * run - inside * other
    assert line_to_item(s, model) == pytest.approx((0.5 * FORAGER.length_m - 2.0, 0.0), abs=1e-9)


def test_a_corner_without_water_behind_is_entered_along_the_other_quay() -> None:
    """A channel of one node, west to east, that ends in the east: in from the west only."""
    chart = Chart(np.array([[1, 1, 1]], np.bool_), PITCH_M)
    s = blank()
    s.x, s.y, s.yaw, s.item_x, s.item_y = 8.0, 0.0, 0.5 * np.pi, 9.9, 1.9
    note_quays(s, P, chart.land, PITCH_M)
    assert (s.quay_x, s.quay_y, s.run) == (1.0, 1.0, 0.0)


def test_in_open_water_there_is_no_quay() -> None:
    s = blank()
    s.quay_x, s.item_x, s.item_y = 1.0, CENTRE + 5.3, CENTRE
    note_quays(s, P, Chart(BASIN, PITCH_M).land, PITCH_M)
    assert not is_quayed(s)
    s.item_x = np.nan
    note_quays(s, P, Chart(BASIN, PITCH_M).land, PITCH_M)
    assert not is_quayed(s)
