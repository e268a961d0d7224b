"""A quay that holds a turning vessel; other contacts are among the checks of `validation`."""

import numpy as np
import pytest

from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.thruster import command_for
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.vessel_models import top_speed
from mjforage.physics.vessels import load_vessel

FORAGER = load_vessel("forager")
BOTH = pytest.mark.parametrize("integrator", Integrator)
BASIN = np.vstack((np.zeros((1, 9), bool), np.ones((4, 9), bool)))  # a quay along the north
QUAY_Y_M = 14.0


def pressed(
    integrator: Integrator, wind_mps: float, current_mps: float, moment: float = 0.0
) -> tuple[float, float]:
    """Force [N] and moment [N m] between the forager and a quay on its port side, at rest."""
    scene = build_scene([FORAGER], navigable=BASIN, pitch_m=4.0)
    simulation = Simulation(scene, integrator=integrator, step_s=0.1)
    simulation.place_vessels(np.array([16.0, QUAY_Y_M - 0.5 * FORAGER.beam_m - 0.01, 0.0]))
    simulation.vessel_wind[:], simulation.vessel_water[:] = (0.0, wind_mps), (0.0, current_mps)
    side, p = 0.5 * moment / FORAGER.lever_m, pack(FORAGER)
    simulation.commands[:] = command_for(p, -side), command_for(p, side)
    contact = simulation.engine.bind("qfrc_constraint")  # filled by the steps that follow
    loads = []
    for _ in range(400):
        simulation.step()
        loads.append(contact[0, 1:3].copy())
    force, turn = -np.mean(loads[-100:], axis=0)
    return float(force), float(turn)


@BOTH
@pytest.mark.parametrize(("current", "moment"), [(0.0, 50.0), (0.0, -50.0), (0.3, 40.0)])
def test_a_quay_bears_a_turning_vessel_at_one_corner(
    integrator: Integrator, current: float, moment: float
) -> None:
    """Thrusters turn it; wind presses it on; the quay holds it by the bow or by the stern.

    67 N of wind bear 50 N m at most 0.75 m from midships: near a corner, as neither can pull.
    """
    force, turn = pressed(integrator, 12.0, current, moment)
    assert turn == pytest.approx(moment, rel=1e-2)
    assert force == pytest.approx(134.16 if current else 67.42, rel=1e-2)


def test_a_current_carries_a_fast_vessel_no_deeper_into_a_quay() -> None:
    """Full ahead and before 0.9 m/s of current, at eight phases of the time step: below 1 mm."""
    scene = build_scene([FORAGER], navigable=BASIN, pitch_m=4.0)
    simulation = Simulation(scene, 8)
    speed, reach = top_speed(FORAGER) + 0.9, QUAY_Y_M - 0.5 * FORAGER.length_m
    pose, velocity = np.zeros((8, 1, 3)), np.zeros((8, 1, 3))
    pose[:, 0, 0], pose[:, 0, 2] = 16.0, 0.5 * np.pi
    pose[:, 0, 1] = reach - 1.0 - speed * simulation.step_s * np.arange(8) / 8
    velocity[..., 1] = speed
    simulation.place_vessels(pose, velocity)
    simulation.vessel_water[:] = 0.0, 0.9
    simulation.commands[:] = command_for(pack(FORAGER), 1e3)
    deepest = -np.inf
    for _ in range(20):
        simulation.step()
        deepest = max(deepest, (simulation.contact_pose[..., 1] - reach).max())
    assert -1e-3 < deepest < 1e-3
