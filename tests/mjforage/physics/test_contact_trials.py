"""Hulls stop at quays and at each other, are not shot out of them, and rest where pushed."""

import dataclasses
import itertools
import math

import numpy as np
import pytest

from mjforage.physics.contact_trials import head_on, into_quay
from mjforage.physics.dynamics.touch import contact
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.vessel_checks import Float64Array, body_axes, first_vessel, inertia_matrix
from mjforage.physics.vessels import NO_WINDAGE, Vessel, load_vessel
from tests.mjforage.physics.validation.contact_checks import dragless
from tests.mjforage.physics.validation.runs import CASES, VESSELS

BOTH = pytest.mark.parametrize("integrator", Integrator)
HULLS = {name: load_vessel(name) for name in VESSELS}
BASIN, PITCH_M, NORTH_M, EAST_M = np.ones((5, 9), np.bool_), 4.0, 18.0, 34.0
PIER = np.ones((7, 12), np.bool_)
PIER[2:4, 4:8] = False  # south face at y = 10, west face at x = 14


def full(vessel: Vessel) -> float:
    return vessel.thruster.command_range[1]


@BOTH
@pytest.mark.parametrize(("name", "load"), CASES)
def test_at_top_speed_a_quay_stops_a_hull_within_5_cm(
    integrator: Integrator, name: str, load: float
) -> None:
    impact = into_quay(HULLS[name], integrator, load)
    assert impact.speed_mps > 1.4
    assert impact.depth_m <= 0.05
    assert impact.rebound <= 0.03
    assert abs(impact.rest_m) <= 2e-3
    assert impact.restless_mps <= 1e-4


@BOTH
@pytest.mark.parametrize(("one", "other"), [*itertools.combinations_with_replacement(VESSELS, 2)])
def test_head_on_any_two_hulls_stop_within_10_cm(
    integrator: Integrator, one: str, other: str
) -> None:
    impact = head_on(HULLS[one], HULLS[other], integrator)
    assert impact.speed_mps > 3.5
    assert impact.depth_m <= 0.10
    assert impact.rebound <= 0.05


@BOTH
def test_laden_foragers_stop_within_10_cm(integrator: Integrator) -> None:
    impact = head_on(HULLS["forager"], HULLS["forager"], integrator, (100.0, 100.0))
    assert impact.depth_m <= 0.10


@BOTH
@pytest.mark.parametrize("name", VESSELS)
def test_a_hull_pushed_into_a_corner_rests(integrator: Integrator, name: str) -> None:
    """At 45 degrees and off it; full thrust turns the others until they lie alongside or rest.

    MuJoCo's friction does not hold a scout at 40 degrees for good: it creeps by 1.2 mm/s.
    """
    hull, yaw = HULLS[name], np.radians([30.0, 40.0, 45.0, 50.0, 60.0])
    scene = build_scene([hull], navigable=BASIN, pitch_m=PITCH_M)
    simulation = Simulation(scene, len(yaw), integrator=integrator)
    pose = np.zeros((len(yaw), 1, 3))
    pose[:, 0] = np.stack((0 * yaw + EAST_M - 3.0, 0 * yaw + NORTH_M - 3.0, yaw), axis=1)
    simulation.place_vessels(pose)
    simulation.commands[:] = full(hull)
    deepest = -math.inf
    for _ in range(round(30.0 / simulation.step_s)):
        simulation.step()
        east, north = extents(simulation.vessel_pose[:, 0], hull)
        deepest = max(deepest, float(np.max(np.maximum(east - EAST_M, north - NORTH_M))))
    assert deepest <= 0.05
    assert np.abs(simulation.vessel_velocity).max() <= 2e-3


def extents(pose: Float64Array, hull: Vessel) -> tuple[Float64Array, Float64Array]:
    """(run,) easternmost and northernmost coordinate [m] of a hull."""
    c, s = np.abs(np.cos(pose[:, 2])), np.abs(np.sin(pose[:, 2]))
    along, aside = 0.5 * hull.length_m, 0.5 * hull.beam_m
    return pose[:, 0] + c * along + s * aside, pose[:, 1] + s * along + c * aside


@BOTH
def test_a_hull_wedged_between_two_overlaps_none(integrator: Integrator) -> None:
    """A scout at full thrust runs into the gap of two foragers, which is narrower than itself."""
    scout, forager = HULLS["scout"], HULLS["forager"]
    fleet, tilts = [scout, forager, forager], (0.0, 0.2, -0.2, 0.4)
    simulation = Simulation(build_scene(fleet), len(tilts), integrator=integrator)
    pose = [
        [[0.0, 0.0, 0.0], [5.0, 0.8 + 0.3 * (t != 0.0), t], [5.0, -0.8 - 0.3 * (t != 0.0), -t]]
        for t in tilts
    ]
    simulation.place_vessels(np.array(pose))
    simulation.commands[:, 0] = full(scout)
    size = [np.array([0.5 * v.length_m - 0.05, 0.5 * v.beam_m - 0.05]) for v in fleet]
    fastest = 0.0
    for _ in range(round(20.0 / simulation.step_s)):
        simulation.step()
        fastest = max(fastest, float(np.abs(simulation.vessel_velocity[..., :2]).max()))
        for run in simulation.vessel_pose:
            for a, b in itertools.combinations(range(3), 2):  # of hulls 5 cm smaller on each side
                assert not contact(run[a], run[b], size[a], size[b])[0]
    assert fastest <= 2.0


@BOTH
def test_impacts_never_add_energy(integrator: Integrator) -> None:
    """Scouts run into resting foragers at random places, angles and speeds, without any drag."""
    fleet = [
        dataclasses.replace(dragless(HULLS[name]), windage=NO_WINDAGE)
        for name in ("scout", "forager")
    ]
    rng, runs = np.random.default_rng(5), 60
    simulation = Simulation(build_scene(fleet), runs, integrator=integrator)
    angle, speed = rng.uniform(0.0, math.tau, runs), rng.uniform(0.5, 3.0, runs)
    pose, velocity = np.zeros((2, runs, 2, 3))
    way = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    pose[:, 0, :2], velocity[:, 0, :2] = 3.0 * way, -speed[:, None] * way
    pose[:, 1, :2] = rng.uniform(-0.5, 0.5, (runs, 2))
    pose[..., 2] = rng.uniform(0.0, math.tau, (runs, 2))
    velocity[..., 2] = rng.uniform(-0.5, 0.5, (runs, 2))
    simulation.place_vessels(pose, velocity)
    energies = [energy(simulation, fleet)]
    for _ in range(round(8.0 / simulation.step_s)):
        simulation.step()
        energies.append(energy(simulation, fleet))
    share = np.array(energies) / energies[0]
    assert share.max() <= 1.003
    assert np.median(share[-1]) < 0.8  # most of them met


def energy(simulation: Simulation, fleet: list[Vessel]) -> Float64Array:
    """(run,) kinetic energy of all vessels [J]."""
    total = np.zeros(simulation.simulations)
    for i, vessel in enumerate(fleet):
        pose, velocity = simulation.vessel_pose[:, i], simulation.vessel_velocity[:, i]
        motion = body_axes(np.hstack((pose, velocity)))
        total += np.einsum("ni,ij,nj->n", motion, 0.5 * inertia_matrix(vessel), motion)
    return total


@BOTH
@pytest.mark.parametrize("name", VESSELS)
def test_a_hull_that_passes_a_pier_feels_nothing(integrator: Integrator, name: str) -> None:
    """Alongside at full speed, from 2 cm of room on, and past its corner at 45 degrees from 20 cm.

    The fast integrator looks as far ahead as a step goes, along faces that the hull may miss.
    """
    hull, room = HULLS[name], np.array([0.02, 0.05, 0.1, 0.2, 0.4])
    runs, slant = 2 * len(room), -0.25 * math.pi
    pose = np.zeros((runs, 1, 3))
    pose[: len(room), 0, 0], pose[: len(room), 0, 1] = 4.0, 10.0 - 0.5 * hull.beam_m - room
    off = np.maximum(room, 0.2) + 0.5 * hull.beam_m
    pose[len(room) :, 0, 0] = 14.0 - (off + 6.0) * math.sqrt(0.5)
    pose[len(room) :, 0, 1] = 10.0 - (off - 6.0) * math.sqrt(0.5)
    pose[len(room) :, 0, 2] = slant
    ends = []
    for navigable in (PIER, None):
        scene = build_scene([hull], navigable=navigable, pitch_m=PITCH_M)
        simulation = Simulation(scene, runs, integrator=integrator)
        simulation.place_vessels(pose)
        simulation.commands[:] = full(hull)
        simulation.step(round(5.0 / simulation.step_s))
        ends.append(simulation.vessel_pose)
    assert ends[0][: len(room), 0, 0].min() > 9.0
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)


@BOTH
def test_a_hull_that_starts_in_a_quay_leaves_it_slowly(integrator: Integrator) -> None:
    scene = build_scene([HULLS["scout"]], navigable=BASIN, pitch_m=PITCH_M)
    simulation = Simulation(scene, integrator=integrator)
    simulation.place_vessels(np.array([EAST_M - 0.5 * 1.35 + 0.2, 8.0, 0.0]))
    fastest = 0.0
    for _ in range(round(30.0 / simulation.step_s)):
        simulation.step()
        fastest = max(fastest, float(np.abs(simulation.vessel_velocity).max()))
    assert fastest <= 0.5
    assert simulation.vessel_pose[0, 0, 0] + 0.675 - EAST_M <= 0.01


@BOTH
def test_friction_holds_a_pressed_hull_up_to_its_limit(integrator: Integrator) -> None:
    """67.4 N of beam wind press a forager on a quay, of which friction takes 0.3: 20.2 N."""
    forager = HULLS["forager"]
    scene = build_scene([forager], navigable=BASIN, pitch_m=PITCH_M)
    simulation = Simulation(scene, 2, integrator=integrator)
    pose = [8.0, NORTH_M - 0.5 * forager.beam_m - 0.01, 0.0]
    simulation.place_vessels(np.array(pose))
    simulation.vessel_wind[:] = 0.0, 12.0
    thrust = np.array([14.0, 28.0])
    simulation.commands[:] = np.sqrt(0.5 * thrust / 0.01108)[:, None, None]
    simulation.step(round(20.0 / simulation.step_s))
    held, slid = simulation.vessel_velocity[:, 0, 0]
    assert abs(held) <= 0.01
    assert slid >= 0.05
    assert abs(first_vessel(simulation)[:, 2]).max() <= 0.05
