import numpy as np
import pytest
from numpy.typing import NDArray

from controllers import Chart, Pilot
from controllers.helm import packed
from controllers.pickup import pick_up
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Simulation
from mjforage.physics.vessel_helm import helm_of
from mjforage.physics.vessels import load_vessel
from tests.controllers.plant import blank

FORAGER = load_vessel("forager")
BASIN, PITCH_M = np.ones((3, 3), np.bool_), 4.0
CENTRE = 4.0
ROOM_M = 0.5 * PITCH_M


def pick(
    items: NDArray[np.float64],
    yaws: NDArray[np.float64],
    seconds: float,
    node: NDArray[np.float64] | None = None,
) -> tuple[NDArray[np.float64], float]:
    """Time at which each item passed the mouth [s], and the farthest midships from the node.

    `node` (episode, 1, 2) is the centre of each one's node, by default the basin's.
    """
    n = yaws.size
    scene = build_scene([FORAGER], navigable=BASIN, pitch_m=PITCH_M)
    simulation, pilot = Simulation(scene, n), Pilot([helm_of(FORAGER)], Chart(BASIN, PITCH_M), n)
    active, to = np.ones(n, np.bool_), np.full((n, 1, 2), CENTRE) if node is None else node
    pose = np.concatenate((to, yaws[:, None, None]), axis=-1)
    simulation.place_vessels(pose)
    taken, ahead, farthest = np.full(n, np.inf), np.full(n, np.inf), 0.0
    for tick in range(round(10 * seconds)):
        if tick % 100 == 0:
            pilot.order(active, to, to, np.ones((n, 1), np.bool_))
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
    heading, speed = pick_up(s, packed(helm_of(FORAGER)), 1.3, 0.1)
    assert (heading, speed < 0.0) == (0.0, True)


def test_items_in_the_corner_of_a_basin_are_reached() -> None:
    """A full-beam mouth does not fit into a corner at 45 degrees, along the quay it does."""
    rng = np.random.default_rng(1)
    sides = rng.choice((-1.0, 1.0), (24, 1, 2))
    items = 4.0 + sides * rng.uniform(5.6, 5.85, (24, 1, 2))  # quays at -2 and 10
    corner = 4.0 + 4.0 * sides
    taken, _ = pick(items, rng.uniform(-np.pi, np.pi, 24), 60.0, corner)
    assert np.mean(np.isfinite(taken)) > 0.8


def test_without_an_item_it_keeps_its_place() -> None:
    items = np.full((1, 1, 2), np.nan)
    _, farthest = pick(items, np.array([0.4]), 5.0)
    assert farthest < 0.01
