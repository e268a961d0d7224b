"""Vessels without thrust and debris: they reach the current; debris has its leeway."""

import math

import numpy as np

from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.vessel_checks import STEP_S
from mjforage.physics.vessels import load_vessel
from tests.mjforage.physics.validation.measures import Measure, Measures, at_most, check
from tests.mjforage.physics.validation.runs import VESSELS

CURRENT = np.array([0.24, -0.18])  # [m/s]
WINDS_MPS = np.array([0.5, 1.0, 2.0, 4.0, 7.0, 10.0])
AIR, WATER = 1.224, 1025.0  # densities [kg/m3]


@check("current", "10a")
def current() -> Measures:
    """From rest over ground in a current of 0.3 m/s, in air that moves with the water, for 600 s.

    What is left of the speed through the water. Where drag is only quadratic, as for debris and
    ahead for the scout, it falls like m / (k t), no faster.
    """
    found: Measures = []
    vessels = [load_vessel(name) for name in VESSELS]
    for integrator in Integrator:
        scene = build_scene(vessels, items=5)
        simulation = Simulation(scene, integrator=integrator, step_s=STEP_S)
        pose = np.zeros((len(vessels), 3))
        pose[:, 1], pose[:, 2] = 300.0 * np.arange(len(vessels)), [0.5, 3.0, 1.0, -2.0]
        simulation.place_vessels(pose)
        simulation.place_items(np.array([[1000.0, 300.0 * k] for k in range(5)]), np.arange(5))
        simulation.vessel_water[:] = simulation.vessel_wind[:] = CURRENT
        simulation.item_water[:] = simulation.item_wind[:] = CURRENT
        simulation.step(6000)
        both = (simulation.vessel_velocity[0, :, :2], simulation.item_velocity[0])
        slips = np.hypot(*(np.vstack(both) - CURRENT).T)
        for name, slip in zip(VESSELS, slips[: len(vessels)], strict=True):
            found.append(at_most(f"{name}, {integrator.value}", slip, 0.006, "m/s"))
        debris = slips[len(vessels) :].max()
        found.append(at_most(f"debris, {integrator.value}", debris, 2e-3, "m/s"))
    return found


@check("leeway", "10b")
def leeway() -> Measures:
    """Every class in winds of 0.5 to 10 m/s over still water, 120 s: drift as a share of the wind.

    It has to lie in the published range of the class, and to follow the square-root law
    k / (1 + k), k = sqrt(rho_a Ca Aa / (rho_w Cw Aw)), whatever the wind.
    """
    found: Measures = []
    for integrator in Integrator:
        scene = build_scene([load_vessel("scout")], items=5)
        simulation = Simulation(scene, WINDS_MPS.size, integrator=integrator, step_s=STEP_S)
        simulation.place_vessels(np.array([-100.0, -100.0, 0.0]))
        simulation.place_items(np.array([[0.0, 10.0 * k] for k in range(5)]), np.arange(5))
        simulation.item_wind[:] = (WINDS_MPS[:, None] * [0.6, 0.8])[:, None]
        simulation.step(1200)
        shares = np.hypot(*np.moveaxis(simulation.item_velocity, -1, 0)) / WINDS_MPS[:, None]
        for kind, share in zip(scene.classes, shares.T, strict=True):
            air = AIR * kind.drag_air * kind.area_air_m2
            k = math.sqrt(air / (WATER * kind.drag_water * kind.area_water_m2))
            label, law = f"{kind.name}, {integrator.value}", k / (1.0 + k)
            low, high = 100.0 * kind.leeway_low, 100.0 * kind.leeway_high
            off = 100.0 * np.abs(share / law - 1.0).max()
            found.append(Measure(label, float(100.0 * share[2]), low, high, "%"))
            found.append(at_most(f"{label}: off the law", off, 0.5, "%"))
    return found
