"""Quays that follow the outline of a place: hulls slide along them, items stay off the land."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.controllers.chart import WALL_M
from mjforage.physics.scene import Scene, build_scene
from mjforage.physics.scene.quays import walls_of
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.vessels import load_vessel
from mjforage.scenario.place import Place

FORAGER, PITCH_M = load_vessel("forager"), 4.0
SIDE = 12  # cells
BASIN = np.ones((SIDE, SIDE), np.bool_)
MIDDLE = 0.5 * PITCH_M * (SIDE - 1)
PUSH_S = 12.0  # of a slide
LAND = np.arange(SIDE)[:, None] * np.ones(SIDE) < SIDE / 2  # rows north of the middle are water


def slanted(degrees: float, edges: int) -> Scene:
    """A basin with a quay through its middle, at so many degrees to the rows, of so many edges."""
    way = direction(degrees)
    along = np.linspace(-26.0, 26.0, edges + 1)[:, None] * way + MIDDLE
    off = 3.0 * np.array([way[1], -way[0]])
    ring = [*along, along[-1] + off, along[0] + off, along[0]]
    return of_ring(ring)


def of_ring(ring: list[NDArray[np.float64]]) -> Scene:
    quays = (tuple((float(x), float(y)) for x, y in ring),)
    walls = walls_of(Place(0, 0, PITCH_M, SIDE, SIDE, quays=quays))
    return build_scene([FORAGER], navigable=BASIN, pitch_m=PITCH_M, walls=walls, items=2)


def direction(degrees: float) -> NDArray[np.float64]:
    return np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])


def pushed(
    scene: Scene, degrees: float, face_m: float, integrator: Integrator
) -> NDArray[np.float64]:
    """Slide of a hull that lies alongside, goes ahead with half its thrust, in an onshore wind.

    Parameters
    ----------
    face_m : of the quay, from the middle

    Returns
    -------
    (tick, 9) turn [rad], then along and off the quay: way [m], speed [m/s], and sampled at the end
    of the tick the force of the quay and that of wind, water and thrust [N]
    """
    simulation = Simulation(scene, integrator=integrator, items=0)
    axes = np.array([direction(degrees), direction(degrees + 90.0)])
    start = MIDDLE + np.array([-14.0, face_m + 0.5 * FORAGER.beam_m + 0.03]) @ axes
    yaw = math.radians(degrees)
    simulation.place_vessels(np.array([[[*start, yaw]]]))
    simulation.vessel_wind[:] = -15.0 * axes[1]
    simulation.commands[:] = 0.8 * FORAGER.thruster.command_range[1]
    names = ("qvel", "qfrc_constraint", "qfrc_passive")
    found = []
    for _ in range(round(PUSH_S / simulation.step_s)):
        simulation.step()
        x, y, turned = simulation.vessel_pose[0, 0]
        way = axes @ (np.array([x, y]) - MIDDLE) - [0.0, face_m]
        rest = [axes @ simulation.engine.bind(name)[0, :2] for name in names]
        found.append([turned - yaw, *way, *np.concatenate(rest)])
    return np.array(found)


def of_momentum(slide: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean force of the quay along and off it in two thirds of a slide [N]: the change of momentum
    without the impulse of wind, water and thrust.
    """
    added = FORAGER.added_mass_surge_kg, FORAGER.added_mass_sway_kg
    gained = (FORAGER.mass_kg + np.array(added)) * (slide[-1, 3:5] - slide[0, 3:5])
    found: NDArray[np.float64] = gained / (2.0 / 3.0 * PUSH_S) - slide[:, 7:].mean(axis=0)
    return found


@pytest.mark.parametrize("integrator", Integrator)
@pytest.mark.parametrize(("degrees", "edges"), [(10.0, 13), (30.0, 1), (30.0, 13), (45.0, 13)])
def test_a_hull_slides_along_a_slanted_quay_as_along_a_straight_one(
    degrees: float, edges: int, integrator: Integrator
) -> None:
    """As along cells: the same way within 1 %, no turn, forces within 3 %.

    The reference's contacts open and close in its steps of 20 ms, and a sample is of the last of
    four stages: samples have a third less than the momentum says, and another mean at joints.
    """
    cells = build_scene([FORAGER], navigable=LAND, pitch_m=PITCH_M, items=2)
    straight = pushed(cells, 0.0, 0.0, integrator)
    found = pushed(slanted(degrees, edges), degrees, WALL_M, integrator)
    went, goes = straight[-1, 1] - straight[0, 1], found[-1, 1] - found[0, 1]
    assert went > 10.0
    assert goes == pytest.approx(went, rel=0.01)
    np.testing.assert_allclose(found[:, [0, 2]], straight[:, [0, 2]], atol=0.01)
    lately, before = found[len(found) // 3 :], straight[len(found) // 3 :]
    np.testing.assert_allclose(of_momentum(lately), of_momentum(before), rtol=0.03)
    assert of_momentum(lately)[1] > 100.0
    if integrator is Integrator.FAST:
        forces = lately[:, 5:7].mean(axis=0)
        np.testing.assert_allclose(forces, before[:, 5:7].mean(axis=0), rtol=0.03)
        np.testing.assert_allclose(of_momentum(lately), forces, rtol=0.003)


@pytest.mark.parametrize("integrator", Integrator)
@pytest.mark.parametrize("bend", [-20.0, -5.0, 5.0, 10.0])
def test_corners_of_a_quay_do_not_catch_a_hull(integrator: Integrator, bend: float) -> None:
    """Along edges of 8 m that turn by so many degrees, away from the water if below 0.

    It loses no more than the speed that goes into the edge ahead.
    """
    turn = np.radians(40.0 + bend * np.arange(3))
    ways = np.stack((np.cos(turn), np.sin(turn)), axis=1)
    outs = ways[:, ::-1] * [-1.0, 1.0]
    ring = np.cumsum(np.vstack(([[MIDDLE - 12.0] * 2], 8.0 * ways)), axis=0)
    scene = of_ring([*ring, *(ring[::-1] - 0.5 * outs[1]), ring[0]])
    simulation = Simulation(scene, integrator=integrator, items=0)
    start = ring[0] + 1.5 * ways[0] + (WALL_M + 0.5 * FORAGER.beam_m + 0.03) * outs[0]
    simulation.place_vessels(np.array([[[*start, turn[0]]]]))
    simulation.commands[:] = FORAGER.thruster.command_range[1] * np.array([1.0, 0.8])
    speeds: list[float] = []
    edge = 0
    while len(speeds) * simulation.step_s < 25.0:
        xy = simulation.vessel_pose[0, 0, :2]
        edge = max(edge, *(k for k in range(3) if k == 0 or (xy - ring[k]) @ ways[k] > 0.0), 0)
        simulation.vessel_wind[:] = -20.0 * outs[edge]
        simulation.step()
        speeds.append(float(np.linalg.norm(simulation.vessel_velocity[0, 0, :2])))
        if (xy - ring[3]) @ ways[2] > -1.5:
            break
    assert edge == 2
    ahead = math.radians(max(bend, 0.0))
    kept = 1.2 * (math.cos(ahead) - math.sin(ahead))
    assert min(speeds[round(4.0 / simulation.step_s) :]) > kept - 0.02


def test_items_rest_at_a_slanted_quay_with_bodies_as_without() -> None:
    """Before 8 m/s, in nodes of water that the quay crosses: off the land, pressed into its edge.

    Items without bodies first, then those beside a vessel, which have one.
    """
    scene, way, out = slanted(30.0, 4), direction(30.0), direction(120.0)
    rest = []
    for off_m in (-12.0, 0.0):
        simulation = Simulation(scene, items=6)
        vessel = MIDDLE + (0.6 + 0.5 * FORAGER.beam_m) * out
        simulation.place_vessels(np.array([[[*vessel, math.radians(30.0)]]]))
        along = np.linspace(-0.9, 0.9, 6)[:, None] + off_m
        start = MIDDLE + along * way + 0.3 * out
        simulation.place_items(start[None], np.zeros((1, 6), np.int64))
        simulation.item_wind[:] = -8.0 * out
        for _ in range(round(10.0 / simulation.step_s)):
            simulation.step()
        assert (simulation._bodies.item_of >= 0).any() == (off_m == 0.0)
        rest.append((simulation.item_xy[0] - MIDDLE) @ out)
    assert min(map(min, rest)) > 0.1, "no middle is over land"
    np.testing.assert_allclose(rest[0], 0.15, atol=0.03)
    np.testing.assert_allclose(rest[1], rest[0], atol=0.005)


def test_a_wall_is_no_bank_and_a_bank_holds_items_alone() -> None:
    """Cells of land hold items in nodes; hulls meet walls, and the place's border has none."""
    ring = [(-2.0, -2.0), (9.0, -2.0), (3.0, 9.0), (-2.0, 9.0), (-2.0, -2.0)]
    walls = walls_of(Place(0, 0, PITCH_M, SIDE, SIDE, quays=(tuple(ring),)))
    np.testing.assert_allclose(walls[:, 4] * 2.0, [math.hypot(6.0, 11.0), 5.0])
    land_side = walls[:, :2] + 0.1 * walls[:, [3, 2]] * [1.0, -1.0]
    assert (land_side @ [11.0, 6.0] < 87.0).all() and (land_side[:, 1] < 9.0).all()
    water = BASIN.copy()
    water[-2:, :2] = False
    model = build_scene([FORAGER], navigable=water, walls=walls, items=1).model
    hull, item = model.geom("forager_0/collider"), model.geom("item-0/collider")

    def meet(one: Any, other: Any) -> bool:
        ones, others = (
            (one.contype[0], one.conaffinity[0]),
            (other.contype[0], other.conaffinity[0]),
        )
        return bool(ones[0] & others[1] or others[0] & ones[1])

    for name, who in (("quay-0", (True, True)), ("bank-0", (False, True))):
        assert (meet(hull, model.geom(name)), meet(item, model.geom(name))) == who
