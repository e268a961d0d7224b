"""Added mass acts in contacts: a quay bears the wind load, a ramming balances momentum."""

import dataclasses
import math

import numpy as np

from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.validation.finding import (
    Float64Array,
    Line,
    Measure,
    Panel,
    near,
    near_share,
    within,
)
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.shared_runs import INTEGRATORS, SPEED_KIND, STEP_S, clock
from mjforage.physics.vessels import Vessel, load_vessel

BASIN = np.vstack((np.zeros((1, 9), bool), np.ones((4, 9), bool)))  # a quay along the north
QUAY_Y_M, PITCH_M = 14.0, 4.0
LOAD_N = 237.6
WIND_MPS, CURRENT_MPS = 12.0, 0.3  # both abeam, towards the quay
SHOWN = 60  # steps in the figure
SPEED_MPS = 2.0
GAPS_M = (0.05, 0.12, 0.19)  # to be run through within one step, and two
HEADINGS = (0.0, 0.9)


@check("quay-force", "14a", "A quay bears the wind load")
def quay_force() -> Parts:
    """A beam wind presses the forager on a quay with 237.6 N, bow to the east and to the west.

    Then 12 m/s of wind and 0.3 m/s of current together. Mean force between hull and quay over the
    last 10 of 60 s, and where the hull's side comes to rest.
    """
    measures: list[Measure] = []
    lines: list[Line] = []
    forager = load_vessel("forager")
    strong = math.sqrt(LOAD_N / _air(forager))
    both = _air(forager) * WIND_MPS**2 + _water(forager, CURRENT_MPS)
    for colour, integrator in enumerate(INTEGRATORS):
        force, _ = _pressed(integrator, 0.0, WIND_MPS, CURRENT_MPS)
        label = f"{SPEED_KIND[integrator]}, wind and current: force"
        last = force[-round(10.0 / STEP_S) :]
        measures.append(near_share(label, float(last.mean()), both, 0.03, "N"))
        for yaw in (0.0, math.pi):
            force, gap = _pressed(integrator, yaw, strong)
            bow = "east" if yaw == 0.0 else "west"
            label = f"{SPEED_KIND[integrator]}, bow {bow}"
            last = force[-round(10.0 / STEP_S) :]
            measures.append(near_share(f"{label}: force", float(last.mean()), LOAD_N, 0.03, "N"))
            measures.append(near(f"{label}: gap", gap, 0.0, 0.02, "m"))
        times = clock(SHOWN + 1)[1:]
        lines.append(Line(SPEED_KIND[integrator], times, force[:SHOWN], colour))
    ends = np.array([0.0, STEP_S * SHOWN])
    lines.append(Line("wind load", ends, np.full(2, LOAD_N), expected=True))
    return tuple(measures), (Panel("Force on the quay, first 6 s", "time (s)", "N", tuple(lines)),)


def _air(vessel: Vessel) -> float:
    """Beam wind load at rest over the square of the wind [N s2/m2]."""
    return 0.5 * 1.224 * vessel.windage.area_side_m2 * vessel.windage.cdt


def _water(vessel: Vessel, current_mps: float) -> float:
    """Load of a current abeam at rest [N]."""
    flow = vessel.crossflow
    assert flow is not None
    drag = 0.5 * flow.water_density_kgpm3 * flow.coefficient * flow.draft_m * flow.length_m
    return (vessel.linear_sway + (vessel.quadratic_sway + drag) * current_mps) * current_mps


def _pressed(
    integrator: Integrator, yaw: float, wind_mps: float, current_mps: float = 0.0
) -> tuple[Float64Array, float]:
    """(row,) force on the quay [N], and the gap between hull and quay at the end [m]."""
    forager = load_vessel("forager")
    scene = build_scene([forager], navigable=BASIN, pitch_m=PITCH_M)
    simulation = Simulation(scene, integrator=integrator, step_s=0.1)
    simulation.place_vessels(np.array([16.0, QUAY_Y_M - 1.0, yaw]))
    simulation.vessel_wind[:], simulation.vessel_water[:] = (0.0, wind_mps), (0.0, current_mps)
    force = []
    for _ in range(round(60.0 / STEP_S)):
        simulation.step()
        force.append(-float(simulation.engine.bind("qfrc_constraint")[0, 1]))
    side = float(simulation.vessel_pose[0, 0, 1]) + 0.5 * forager.beam_m
    return np.array(force), QUAY_Y_M - side


@check("ramming", "14b", "A ramming balances momentum")
def ramming() -> Parts:
    """A scout at 2 m/s rams a resting forager amidships, drag taken away from both.

    Momentum with added mass that one loses and the other wins, against each other and against a
    plastic impact of m + X_a of the scout and m + Y_a of the forager; three gaps, two headings.
    """
    rammer, rammed = dragless(load_vessel("scout")), dragless(load_vessel("forager"))
    surge = rammer.mass_kg + rammer.added_mass_surge_kg
    sway = rammed.mass_kg + rammed.added_mass_sway_kg
    expected = SPEED_MPS / (1.0 / surge + 1.0 / sway)
    measures: list[Measure] = []
    lines: list[Line] = []
    for colour, integrator in enumerate(INTEGRATORS):
        runs = [_rammed(rammer, rammed, integrator, gap, yaw) for gap in GAPS_M for yaw in HEADINGS]
        ends = np.array([run[-1] for run in runs])
        lost, won = surge * (SPEED_MPS - ends[:, 0]), sway * ends[:, 1]
        kind = SPEED_KIND[integrator]
        for words, ratio, slack in (
            ("impulse over plastic impact", lost / expected, 0.03),
            ("won over lost", won / lost, 5e-3),
        ):
            measures.append(within(f"{kind}: {words}, least", ratio.min(), 1 - slack, 1 + slack))
            measures.append(within(f"{kind}: {words}, most", ratio.max(), 1 - slack, 1 + slack))
        times = clock(len(runs[2]))
        lines.append(Line(f"scout, {kind}", times, runs[2][:, 0], colour))
        lines.append(Line(f"forager, {kind}", times, runs[2][:, 1], colour + 2))
    ends_s = np.array([0.0, 1.5])
    together = np.full(2, expected / sway)
    lines.append(Line("plastic impact", ends_s, together, expected=True))
    panel = Panel("Speed along the scout's course", "time (s)", "m/s", tuple(lines))
    return tuple(measures), (panel,)


def dragless(vessel: Vessel) -> Vessel:
    """Without drag, and with the centre of gravity at midships, for a central impact."""
    return dataclasses.replace(
        vessel,
        linear_surge=1e-9, linear_sway=1e-9, linear_yaw=1e-9,
        quadratic_surge=0.0, quadratic_sway=0.0, quadratic_yaw=0.0,
        crossflow=None, cog_x_m=0.0,
    )  # fmt: skip


def _rammed(
    rammer: Vessel, rammed: Vessel, integrator: Integrator, gap_m: float, yaw: float
) -> Float64Array:
    """(row, 2) speed of both along the rammer's course [m/s]."""
    simulation = Simulation(build_scene([rammer, rammed]), integrator=integrator, step_s=0.1)
    start = -0.5 * rammer.length_m - 0.5 * rammed.beam_m - gap_m
    c, s = math.cos(yaw), math.sin(yaw)
    simulation.place_vessels(
        np.array([[start * c, start * s, yaw], [0.0, 0.0, yaw + 0.5 * math.pi]]),
        np.array([[SPEED_MPS * c, SPEED_MPS * s, 0.0], [0.0, 0.0, 0.0]]),
    )
    rows = [simulation.vessel_velocity[0, :, :2] @ [c, s]]
    for _ in range(15):
        simulation.step()
        rows.append(simulation.vessel_velocity[0, :, :2] @ [c, s])
    return np.array(rows)
