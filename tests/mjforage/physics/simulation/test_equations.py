"""Load and mass matrix of vessels in MuJoCo; other motions are among the checks of `validation`."""

import dataclasses

import pytest

from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.vessels import load_vessel

OTTER, FORAGER = load_vessel("otter"), load_vessel("forager")
BOTH = pytest.mark.parametrize("integrator", Integrator)


@BOTH
def test_load_slows_a_forager_and_makes_it_heavy(integrator: Integrator) -> None:
    scene = build_scene([FORAGER])
    simulation = Simulation(scene, 2, integrator=integrator, step_s=0.1)
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


def test_light_hulls_without_offset_keep_the_whole_mass_matrix() -> None:
    vessel = dataclasses.replace(OTTER, cog_x_m=0.0)
    assert build_scene([vessel]).model.M_rownnz.tolist() == [1, 2, 3]
