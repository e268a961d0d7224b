"""What must not depend on where the bow points, or on a steady current, and what forces must be."""

import dataclasses
import math

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.hydrodynamics.conditions import Conditions
from mjforage.hydrodynamics.reference import simulate
from mjforage.scene import build_scene
from mjforage.simulation import Integrator, Simulation
from mjforage.vessels import load_vessel

OTTER, FORAGER = load_vessel("otter"), load_vessel("forager")
SCENE = build_scene([OTTER])
BOTH = pytest.mark.parametrize("integrator", Integrator)
STEP_S = 0.1
TURN = ((0.0, 60.0, 40.0),)  # from t [s] on: port, starboard [rad/s]
WEAVE = ((0.0, 50.0, 50.0), (10.0, 50.0, 35.0), (25.0, 35.0, 50.0), (40.0, 50.0, 50.0))
HARD = ((0.0, 60.0, 60.0), (10.0, 60.0, 30.0), (25.0, -40.0, 50.0), (40.0, 80.0, -20.0))

Schedule = tuple[tuple[float, float, float], ...]


def command_at(schedule: Schedule, t: float) -> tuple[float, float]:
    row = [row for row in schedule if row[0] <= t + 1e-9][-1]
    return row[1], row[2]


def run(
    schedule: Schedule,
    integrator: Integrator,
    step_s: float,
    yaw: float = 0.0,
    current: tuple[float, float] = (0.0, 0.0),
    wind: tuple[float, float] = (0.0, 0.0),
    seconds: float = 60.0,
) -> NDArray[np.float64]:
    """(row, 3) poses, the hull starting with the current."""
    simulation = Simulation(SCENE, integrator=integrator, step_s=step_s)
    simulation.place_vessels(np.array([0.0, 0.0, yaw]), np.array([*current, 0.0]))
    simulation.vessel_water[:], simulation.vessel_wind[:] = current, wind
    poses = [simulation.vessel_pose[0, 0]]
    for k in range(round(seconds / step_s)):
        simulation.commands[:] = command_at(schedule, k * step_s)
        simulation.step()
        poses.append(simulation.vessel_pose[0, 0])
    return np.array(poses)


@BOTH
@pytest.mark.parametrize("yaw", [0.5, 2.0, -2.5])
def test_a_turned_start_turns_the_whole_run(integrator: Integrator, yaw: float) -> None:
    c, s = math.cos(yaw), math.sin(yaw)
    still = run(TURN, integrator, STEP_S)
    turned = run(TURN, integrator, STEP_S, yaw)
    expected = still @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + [0.0, 0.0, yaw]
    assert np.hypot(*still.T[:2]).max() > 2.0
    np.testing.assert_allclose(turned, expected, rtol=0, atol=1e-6)


@BOTH
def test_a_current_only_translates(integrator: Integrator) -> None:
    current = (0.24, -0.18)
    still, moved = run(TURN, integrator, STEP_S), run(TURN, integrator, STEP_S, current=current)
    t = STEP_S * np.arange(len(still))[:, None]
    expected = still + np.hstack((t * current[0], t * current[1], 0.0 * t))
    np.testing.assert_allclose(moved, expected, rtol=0, atol=1e-6)


@pytest.mark.parametrize("conditions", [Conditions(), Conditions(heading_rad=0.7)])
def test_mujoco_agrees_with_the_plain_equations(conditions: Conditions) -> None:
    times = np.linspace(0.0, 60.0, 1201)
    commands = np.array([command_at(WEAVE, t) for t in times[:-1].tolist()])
    plain = simulate(OTTER, conditions, times, commands)[:, :3]
    ours = run(WEAVE, Integrator.REFERENCE, 0.05, conditions.heading_rad)
    np.testing.assert_allclose(ours, plain, rtol=0, atol=1e-4)


def test_fast_and_reference_agree_after_a_minute_of_hard_manoeuvring() -> None:
    true = run(HARD, Integrator.REFERENCE, 0.0125)[-1]
    for integrator, limit_m in ((Integrator.FAST, 0.02), (Integrator.REFERENCE, 0.02)):
        end = run(HARD, integrator, STEP_S)[-1]
        assert np.hypot(*(end - true)[:2]) < limit_m


@pytest.mark.parametrize(
    ("integrator", "steps", "order"),
    [
        (Integrator.REFERENCE, (0.05, 0.025, 0.0125), 4.0),
        (Integrator.FAST, (0.1, 0.05, 0.025), 2.0),
    ],
)
def test_step_halving_converges_at_the_integrators_order(
    integrator: Integrator, steps: tuple[float, ...], order: float
) -> None:
    wind = (4.0, 6.0)  # of no consequence for the otter
    ends = np.array(
        [run(TURN, integrator, step, 0.3, (0.2, 0.1), wind, 10.0)[-1] for step in steps]
    )
    coarse, fine = np.linalg.norm(np.diff(ends, axis=0)[:, :2], axis=1)
    assert math.log2(coarse / fine) > order - 0.4


@BOTH
def test_a_hull_at_rest_stays(integrator: Integrator) -> None:
    poses = run(((0.0, 0.0, 0.0),), integrator, STEP_S, 0.4, seconds=300.0)
    np.testing.assert_allclose(poses - poses[0], 0.0, atol=1e-12)


@BOTH
def test_load_slows_a_forager_and_makes_it_heavy(integrator: Integrator) -> None:
    scene = build_scene([FORAGER])
    simulation = Simulation(scene, 2, integrator=integrator)
    simulation.load[:, 0] = 0.0, 100.0
    simulation.commands[:] = 60.0
    windage = FORAGER.windage
    air = 0.5 * 1.224 * windage.area_front_m2 * windage.cdl_bow
    simulation.step(1)
    first = simulation.vessel_velocity[:, 0, 0]
    added = FORAGER.added_mass_surge_kg + FORAGER.mass_kg
    assert first[0] / first[1] == pytest.approx((added + 20.0) / added, rel=2e-2)
    simulation.step(600)
    speed = simulation.vessel_velocity[:, 0, 0]
    thrust = 2.0 * 0.01108 * 60.0**2
    for u, drag in zip(speed.tolist(), (30.0, 60.0), strict=True):
        assert 77.55 * u + (drag + air) * u * u == pytest.approx(thrust, rel=1e-6)


@BOTH
def test_unpowered_hull_reaches_the_current(integrator: Integrator) -> None:
    simulation = Simulation(SCENE, integrator=integrator)
    simulation.vessel_water[:] = 0.3, -0.2
    simulation.step(6000)
    np.testing.assert_allclose(simulation.vessel_velocity[0, 0, :2], [0.3, -0.2], atol=1e-3)


def test_light_hulls_without_offset_keep_the_whole_mass_matrix() -> None:
    vessel = dataclasses.replace(OTTER, cog_x_m=0.0)
    assert build_scene([vessel]).model.M_rownnz.tolist() == [1, 2, 3]
