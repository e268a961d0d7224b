"""Added mass acts in contacts: quay forces equal wind loads, rammings balance momentum."""

import dataclasses
import math

import numpy as np
import pytest

from mjforage.scene import build_scene
from mjforage.simulation import Integrator, Simulation
from mjforage.vessels import load_vessel

SCOUT, FORAGER = load_vessel("scout"), load_vessel("forager")
BOTH = pytest.mark.parametrize("integrator", Integrator)
BASIN = np.vstack((np.zeros((1, 9), bool), np.ones((4, 9), bool)))  # a quay along the north
QUAY_Y_M = 14.0
LOAD_N = 237.6
DRAGLESS = {
    **dict.fromkeys(("linear_surge", "linear_sway", "linear_yaw"), 1e-9),
    **dict.fromkeys(("quadratic_surge", "quadratic_sway", "quadratic_yaw"), 0.0),
    "crossflow": None,
    "cog_x_m": 0.0,
}


@BOTH
@pytest.mark.parametrize("yaw", [0.0, math.pi])
def test_quay_bears_the_wind_load(integrator: Integrator, yaw: float) -> None:
    scene = build_scene([FORAGER], navigable=BASIN, pitch_m=4.0)
    simulation = Simulation(scene, integrator=integrator)
    windage = FORAGER.windage
    speed = math.sqrt(LOAD_N / (0.5 * 1.224 * windage.area_side_m2 * windage.cdt))
    simulation.place_vessels(np.array([16.0, QUAY_Y_M - 1.0, yaw]))
    simulation.vessel_wind[:] = 0.0, speed
    force = simulation.engine.bind("qfrc_constraint")
    simulation.step(600)
    assert force[0, 1] == pytest.approx(-LOAD_N, rel=0.03)
    assert simulation.vessel_pose[0, 0, 1] == pytest.approx(QUAY_Y_M - 0.54, abs=0.02)


@BOTH
@pytest.mark.parametrize("gap_m", [0.05, 0.12, 0.19])
@pytest.mark.parametrize("yaw", [0.0, 0.9])
def test_ramming_balances_momentum(integrator: Integrator, gap_m: float, yaw: float) -> None:
    rammer = dataclasses.replace(SCOUT, **DRAGLESS)  # type: ignore[arg-type]
    rammed = dataclasses.replace(FORAGER, **DRAGLESS)  # type: ignore[arg-type]
    simulation = Simulation(build_scene([rammer, rammed]), integrator=integrator)
    speed, start = 2.0, -0.675 - 0.54 - gap_m
    c, s = math.cos(yaw), math.sin(yaw)
    simulation.place_vessels(
        np.array([[start * c, start * s, yaw], [0.0, 0.0, yaw + 0.5 * math.pi]]),
        np.array([[speed * c, speed * s, 0.0], [0.0, 0.0, 0.0]]),
    )
    simulation.step(15)
    ahead = simulation.vessel_velocity[0, :, :2] @ [c, s]
    surge = rammer.mass_kg + rammer.added_mass_surge_kg
    sway = rammed.mass_kg + rammed.added_mass_sway_kg
    lost, won = surge * (speed - ahead[0]), sway * ahead[1]
    assert lost == pytest.approx(won, rel=0.02)
    assert lost == pytest.approx(speed / (1.0 / surge + 1.0 / sway), rel=0.10)


@BOTH
def test_items_stop_at_quays_and_give_way_to_hulls(integrator: Integrator) -> None:
    scene = build_scene([FORAGER], navigable=BASIN, pitch_m=4.0, items=2)
    simulation = Simulation(scene, integrator=integrator)
    simulation.place_vessels(np.array([4.0, 4.0, 0.0]))
    simulation.place_items(np.array([[20.0, 12.0], [8.0, 4.0]]), np.array([0, 2]))
    simulation.item_wind[0, 0] = 0.0, 10.0
    simulation.commands[:] = 60.0
    simulation.step(100)
    (_, y), (x, _) = simulation.item_xy[0]
    assert y == pytest.approx(QUAY_Y_M - 0.1, abs=0.02)
    bow = simulation.vessel_pose[0, 0, 0] + 1.0
    assert x == pytest.approx(bow + 0.1, abs=0.03)
    assert bow > 9.0
