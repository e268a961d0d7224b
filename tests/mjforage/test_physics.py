"""Checks of whole simulations that belong to no single room: inertia, energy, drifting."""

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.scene import build_scene
from mjforage.simulation import Integrator, Simulation
from mjforage.vessels import Vessel, load_vessel

BOTH = pytest.mark.parametrize("integrator", list(Integrator))
OTTER = load_vessel("otter")
FORAGER = load_vessel("forager")
SCOUT = load_vessel("scout")


def alone(
    vessel: Vessel,
    yaws: NDArray[np.float64],
    integrator: Integrator,
    step_s: float = 0.1,
    velocity: tuple[float, float] = (0.0, 0.0),
) -> Simulation:
    """One hull on open water per heading."""
    simulation = Simulation(build_scene([vessel]), yaws.size, integrator=integrator, step_s=step_s)
    pose = np.zeros((yaws.size, 1, 3))
    pose[:, 0, 2] = yaws
    simulation.place_vessels(pose, np.broadcast_to([*velocity, 0.0], pose.shape))
    return simulation


def body_velocity(simulation: Simulation) -> NDArray[np.float64]:
    """(simulation, 3) surge, sway, yaw rate of the first hull."""
    yaw, v = simulation.vessel_pose[:, 0, 2], simulation.vessel_velocity[:, 0]
    surge = np.cos(yaw) * v[:, 0] + np.sin(yaw) * v[:, 1]
    sway = np.cos(yaw) * v[:, 1] - np.sin(yaw) * v[:, 0]
    return np.stack((surge, sway, v[:, 2]), axis=1)


HEADINGS = np.linspace(0.0, 2.0 * np.pi, 9)[:-1] + 0.3


@BOTH
@pytest.mark.parametrize("vessel", [OTTER, FORAGER, SCOUT], ids=lambda v: v.name)
def test_acceleration_from_rest_is_the_same_at_every_heading(
    vessel: Vessel, integrator: Integrator
) -> None:
    simulation = alone(vessel, HEADINGS, integrator, 0.01)
    high = vessel.thruster.command_range[1]
    simulation.commands[:] = [0.6 * high, 0.3 * high]
    simulation.step(20)
    found = body_velocity(simulation)
    assert found[0, 0] > 0.01 and abs(found[0, 2]) > 1e-4
    np.testing.assert_allclose(found, found[:1].repeat(8, axis=0), atol=1e-12)


@BOTH
def test_an_unpowered_hull_loses_energy_at_every_step(integrator: Integrator) -> None:
    simulation = alone(OTTER, np.array([0.2]), integrator, velocity=(1.0, 0.4))
    speed = []
    for _ in range(100):
        simulation.step()
        u, v, r = body_velocity(simulation)[0]
        p = OTTER
        rigid = p.mass_kg * (u**2 + v**2 + 2.0 * v * r * p.cog_x_m) + p.inertia_z_kgm2 * r**2
        added = p.added_mass_surge_kg * u**2 + p.added_mass_sway_kg * v**2
        speed.append(rigid + added + p.added_mass_yaw_kgm2 * r**2)
    assert speed[-1] < 0.01 * speed[0]
    assert (np.diff(speed) < 1e-9 * speed[0]).all()


@BOTH
def test_an_unpowered_hull_and_debris_reach_the_current(integrator: Integrator) -> None:
    scene = build_scene([FORAGER, SCOUT], items=3)
    simulation = Simulation(scene, 1, integrator=integrator)
    simulation.place_vessels(np.array([[[0.0, 0.0, 0.5], [0.0, 9.0, 0.0]]]))
    simulation.place_items(np.array([[[5.0, 0.0], [9.0, 0.0], [13.0, 0.0]]]), np.zeros((1, 3)))
    simulation.vessel_water[:] = simulation.item_water[:] = [0.2, 0.1]
    simulation.vessel_wind[:] = simulation.item_wind[:] = [0.2, 0.1]  # air moves with the water
    simulation.step(4000)
    forager, scout = simulation.vessel_velocity[0, :, :2]
    np.testing.assert_allclose(forager, [0.2, 0.1], atol=1e-9)  # its drag is partly linear
    # Quadratic drag alone: the slip falls like m / (X t) (the scout's surge, 400 s).
    slip = (SCOUT.mass_kg + SCOUT.added_mass_surge_kg) / (SCOUT.quadratic_surge * 400.0)
    assert np.hypot(*(scout - [0.2, 0.1])) == pytest.approx(slip, rel=0.1)
    np.testing.assert_allclose(simulation.item_velocity[0], [[0.2, 0.1]] * 3, atol=2e-3)
