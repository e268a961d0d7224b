"""Unpowered boats and debris: they reach the current, and the wind moves debris by its leeway."""

import math

import numpy as np

from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.validation.finding import (
    Float64Array,
    Line,
    Measure,
    Panel,
    Span,
    at_most,
    dashed,
    within,
)
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.shared_runs import INTEGRATORS, SPEED_KIND, VESSELS, clock
from mjforage.physics.vessels import load_vessel

CURRENT = np.array([0.24, -0.18])  # [m/s]
DRIFT_S = 600.0
WINDS_MPS = np.array([0.5, 1.0, 2.0, 4.0, 7.0, 10.0])
AIR, WATER = 1.224, 1025.0  # densities [kg/m3]


@check("current", "10a", "Unpowered boats and debris reach the current")
def current() -> Parts:
    """From rest over ground in a current of 0.3 m/s, in air that moves with the water, for 600 s.

    What is left of the speed through the water. Where drag is only quadratic, as for debris and
    ahead for the scout, it falls like m / (k t), no faster.
    """
    names, measures = VESSELS, []
    for integrator in INTEGRATORS:
        slips = _slips(integrator)
        last = slips[-1]
        boats = zip(names, last[: len(names)], strict=True)
        for name, slip in boats:
            label = f"{name}, {SPEED_KIND[integrator]}"
            measures.append(at_most(label, slip, 0.02 * math.hypot(*CURRENT), "m/s"))
        debris = float(last[len(names) :].max())
        measures.append(at_most(f"debris, {SPEED_KIND[integrator]}", debris, 2e-3, "m/s"))
    times = clock(len(slips), DRIFT_S / (len(slips) - 1))
    lines = [Line(name, times, slips[:, k], k) for k, name in enumerate(names)]
    lines.append(Line("debris (bottle)", times, slips[:, len(names)], len(names)))
    panel = Panel("Speed through the water", "time (s)", "m/s", tuple(lines), log_y=True)
    return tuple(measures), (panel,)


def _slips(integrator: Integrator) -> Float64Array:
    """(row, body) speed through the water: vessels, then one item of each class."""
    hulls = [load_vessel(name) for name in VESSELS]
    scene = build_scene(hulls, items=5)
    simulation = Simulation(scene, integrator=integrator, step_s=0.1)
    pose = np.zeros((len(hulls), 3))
    pose[:, 1], pose[:, 2] = 300.0 * np.arange(len(hulls)), [0.5, 3.0, 1.0, -2.0]
    simulation.place_vessels(pose)
    simulation.place_items(np.array([[1000.0, 300.0 * k] for k in range(5)]), np.arange(5))
    for flow in (simulation.vessel_water, simulation.vessel_wind):
        flow[:] = CURRENT
    simulation.item_water[:], simulation.item_wind[:] = CURRENT, CURRENT
    rows = []
    for _ in range(301):
        both = (simulation.vessel_velocity[0, :, :2], simulation.item_velocity[0])
        rows.append(np.hypot(*(np.vstack(both) - CURRENT).T))
        simulation.step(round(DRIFT_S / 300 / simulation.step_s))
    return np.array(rows)


@check("leeway", "10b", "Leeway of debris")
def leeway() -> Parts:
    """Every class in winds of 0.5 to 10 m/s over still water, 120 s: drift as a share of the wind.

    It has to lie in the published range of the class, and to follow the square-root law
    k / (1 + k), k = sqrt(rho_a Ca Aa / (rho_w Cw Aw)), whatever the wind.
    """
    measures: list[Measure] = []
    laws: dict[str, float] = {}
    for integrator in INTEGRATORS:
        shares = _leeway(integrator)
        classes = build_scene([load_vessel("scout")]).classes
        for kind, found in zip(classes, shares.T, strict=True):
            air = AIR * kind.drag_air * kind.area_air_m2
            k = math.sqrt(air / (WATER * kind.drag_water * kind.area_water_m2))
            laws[kind.name] = law = k / (1.0 + k)
            label = f"{kind.name}, {SPEED_KIND[integrator]}"
            in_range = within(
                label, 100.0 * found[2], 100.0 * kind.leeway_low, 100.0 * kind.leeway_high, "%"
            )
            off = float(np.abs(found / law - 1.0).max())
            measures += [in_range, at_most(f"{label}: off the law", 100.0 * off, 0.5, "%")]
    spans = tuple(
        Span(float(i), 100.0 * kind.leeway_low, 100.0 * kind.leeway_high)
        for i, kind in enumerate(classes)
    )
    names = tuple(kind.name for kind in classes)
    places = np.arange(len(names), dtype=np.float64)
    drift = tuple(
        Line(kind.name, WINDS_MPS, shares[:, i] * WINDS_MPS, i) for i, kind in enumerate(classes)
    )
    forms = [Line("", WINDS_MPS, law * WINDS_MPS, expected=True) for law in laws.values()]
    drift = (*drift, *forms, dashed("square-root law"))
    lines = (Line("in 2 m/s of wind", places, 100.0 * shares[2], points=True),)
    return tuple(measures), (
        Panel("Leeway by class", "", "% of the wind", lines, spans=spans,
              span_label="published range", x_names=names),
        Panel("Drift over wind", "wind (m/s)", "drift (m/s)", drift),
    )  # fmt: skip


def _leeway(integrator: Integrator) -> Float64Array:
    """(wind, class) drift over wind."""
    scene = build_scene([load_vessel("scout")], items=5)
    simulation = Simulation(scene, WINDS_MPS.size, integrator=integrator, step_s=0.1)
    simulation.place_vessels(np.array([-100.0, -100.0, 0.0]))
    simulation.place_items(np.array([[0.0, 10.0 * k] for k in range(5)]), np.arange(5))
    simulation.item_wind[:] = (WINDS_MPS[:, None] * [0.6, 0.8])[:, None]
    simulation.step(1200)
    speed = np.hypot(*np.moveaxis(simulation.item_velocity, -1, 0))
    return np.asarray(speed / WINDS_MPS[:, None])
