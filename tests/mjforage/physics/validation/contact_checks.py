"""Contacts of vessels, quays and items; the mouth; what a mission notes of vessels."""

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad

from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.dynamics import start_state
from mjforage.mission.initial_state import InitialState
from mjforage.physics.dynamics.collecting import Reach, collect_at_mouth, mouths_of
from mjforage.physics.dynamics.period_monitor import (
    MonitorSetup,
    Motion,
    PeriodRecord,
    Tick,
    monitor,
)
from mjforage.physics.dynamics.tracks import LandGrid
from mjforage.physics.hydrodynamics.parameters import pack_fleet
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.vessel_checks import STEP_S, Float64Array, in_commands
from mjforage.physics.vessels import NO_WINDAGE, Vessel, load_vessel
from mjforage.scenario.scenario import Physics
from tests.mjforage.physics.validation.measures import Measure, Measures, check, near, near_share
from tests.mjforage.physics.validation.momentum import thrust
from tests.mjforage.physics.validation.runs import CASES, case_name, momentum_rows

PITCH_M = 4.0
QUAYED = np.vstack((np.zeros((1, 9), bool), np.ones((4, 9), bool)))  # a quay along the north
QUAY_Y_M = 14.0
BASIN, CHANNEL = np.ones((5, 5), np.bool_), np.ones((5, 9), np.bool_)
NORTH_M, EAST_M, CHANNEL_EAST_M = 18.0, 18.0, 34.0  # edges of the basin and of the channel
LOAD_N, SPEED_MPS, RADIUS_M = 237.6, 2.0, 0.1
MOORED_W = 833.8  # NTNU, power usage of the Otter
RIDE_S = 20.0


@check("quay-force", "14a")
def quay_force() -> Measures:
    """A beam wind presses the forager on a quay with 237.6 N, bow to the east and to the west.

    Then 12 m/s of wind and 0.3 m/s of current together. Mean force between vessel and quay over the
    last 10 of 60 s, and where the vessel's side comes to rest.
    """
    vessel = load_vessel("forager")
    flow = vessel.crossflow
    assert flow is not None
    air = 0.5 * 1.224 * vessel.windage.area_side_m2 * vessel.windage.cdt
    drag = 0.5 * flow.water_density_kgpm3 * flow.coefficient * flow.draft_m * flow.length_m
    water = (vessel.linear_sway + (vessel.quadratic_sway + drag) * 0.3) * 0.3
    found: Measures = []
    for integrator in Integrator:
        force, _ = _pressed(integrator, 0.0, 12.0, 0.3)
        label, both = f"{integrator.value}, wind and current: force", air * 12.0**2 + water
        found.append(near_share(label, force, both, 5e-3, "N"))
        for bow, yaw in (("east", 0.0), ("west", math.pi)):
            force, gap = _pressed(integrator, yaw, math.sqrt(LOAD_N / air))
            label = f"{integrator.value}, bow {bow}"
            found.append(near_share(f"{label}: force", force, LOAD_N, 5e-3, "N"))
            found.append(near(f"{label}: gap", gap, 0.0, 0.02, "m"))
    return found


def _pressed(
    integrator: Integrator, yaw: float, wind_mps: float, current_mps: float = 0.0
) -> tuple[float, float]:
    """Force on the quay [N], and the gap between vessel and quay at the end [m]."""
    forager = load_vessel("forager")
    scene = build_scene([forager], navigable=QUAYED, pitch_m=PITCH_M)
    simulation = Simulation(scene, integrator=integrator, step_s=STEP_S)
    simulation.place_vessels(np.array([16.0, QUAY_Y_M - 1.0, yaw]))
    simulation.vessel_wind[:], simulation.vessel_water[:] = (0.0, wind_mps), (0.0, current_mps)
    force = []
    for _ in range(600):
        simulation.step()
        force.append(-float(simulation.engine.bind("qfrc_constraint")[0, 1]))
    side = float(simulation.vessel_pose[0, 0, 1]) + 0.5 * forager.beam_m
    return float(np.mean(force[-100:])), QUAY_Y_M - side


def dragless(vessel: Vessel) -> Vessel:
    """Without drag, and with the centre of gravity at midships, for a central impact."""
    return dataclasses.replace(
        vessel,
        linear_surge=1e-9, linear_sway=1e-9, linear_yaw=1e-9,
        quadratic_surge=0.0, quadratic_sway=0.0, quadratic_yaw=0.0,
        crossflow=None, cog_x_m=0.0,
    )  # fmt: skip


@check("ramming", "14b")
def ramming() -> Measures:
    """A scout at 2 m/s rams a resting forager amidships, drag taken away from both.

    Momentum with added mass that one loses and the other gains, against each other and against a
    plastic impact of m + X_a of the scout and m + Y_a of the forager; three gaps, two headings.
    """
    rammer, rammed = dragless(load_vessel("scout")), dragless(load_vessel("forager"))
    surge = rammer.mass_kg + rammer.added_mass_surge_kg
    sway = rammed.mass_kg + rammed.added_mass_sway_kg
    expected = SPEED_MPS / (1.0 / surge + 1.0 / sway)
    found: Measures = []
    for integrator in Integrator:
        # Gaps to be run through within one step, and two.
        ends = np.array(
            [
                _rammed(rammer, rammed, integrator, gap, yaw)
                for gap in (0.05, 0.12, 0.19)
                for yaw in (0.0, 0.9)
            ]
        )
        lost, gained = surge * (SPEED_MPS - ends[:, 0]), sway * ends[:, 1]
        for words, ratio, slack in (
            ("impulse over plastic impact", lost / expected, 0.03),
            ("gained over lost", gained / lost, 5e-3),
        ):
            label = f"{integrator.value}: {words}"
            found.append(near(f"{label}, least", ratio.min(), 1.0, slack))
            found.append(near(f"{label}, most", ratio.max(), 1.0, slack))
    return found


def _rammed(
    rammer: Vessel, rammed: Vessel, integrator: Integrator, gap_m: float, yaw: float
) -> Float64Array:
    """(2,) speed of both along the rammer's heading after 1.5 s [m/s]."""
    simulation = Simulation(build_scene([rammer, rammed]), integrator=integrator, step_s=STEP_S)
    start = -0.5 * rammer.length_m - 0.5 * rammed.beam_m - gap_m
    c, s = math.cos(yaw), math.sin(yaw)
    simulation.place_vessels(
        np.array([[start * c, start * s, yaw], [0.0, 0.0, yaw + 0.5 * math.pi]]),
        np.array([[SPEED_MPS * c, SPEED_MPS * s, 0.0], [0.0, 0.0, 0.0]]),
    )
    simulation.step(15)
    return np.asarray(simulation.vessel_velocity[0, :, :2] @ [c, s])


@check("items", "16")
def items() -> Measures:
    """A forager pushes one item before it, wind of 10 m/s blows others onto a quay, into a corner.

    Where they come to rest: their middles an item's radius, 0.1 m, off what they touch.
    """
    found: Measures = []
    for integrator in Integrator:
        scene = build_scene([load_vessel("forager")], navigable=CHANNEL, pitch_m=PITCH_M, items=4)
        simulation = Simulation(scene, integrator=integrator, step_s=STEP_S, items=3)
        simulation.place_vessels(np.array([3.0, 4.0, 0.0]))
        simulation.place_items(np.array([[6.0, 4.0], [20.0, 16.0], [32.0, 16.5]]), np.zeros(3, int))
        simulation.item_wind[0, 1:] = (0.0, 10.0), (8.0, 8.0)
        simulation.commands[:] = 60.0
        simulation.step(120)
        bow, xy, kind = (
            simulation.vessel_pose[0, 0, 0] + 1.0,
            simulation.item_xy[0],
            integrator.value,
        )
        found += [
            near(f"{kind}: before the bow", xy[0, 0] - bow, RADIUS_M, 0.02, "m"),
            near(f"{kind}: off a quay", NORTH_M - xy[1, 1], RADIUS_M, 0.01, "m"),
            near(f"{kind}: in a corner, off the north", NORTH_M - xy[2, 1], RADIUS_M, 0.01, "m"),
            near(f"{kind}: off the east", CHANNEL_EAST_M - xy[2, 0], RADIUS_M, 0.01, "m"),
        ]
    return found


@check("mouth", "17")
def mouth() -> Measures:
    """A forager at an angle; items tried every millimetre along its middle line and its bow.

    The mouth is as wide as the vessel and reaches from 0.3 m behind the bow to 0.12 m before it.
    With room for three it takes three; a scout takes none.
    """
    forager = load_vessel("forager")
    bow, side = 0.5 * forager.length_m, 0.5 * forager.beam_m
    places = np.arange(-2.0, 2.0, 1e-3)
    zero = np.zeros(places.size)
    ahead = places[_taken(np.stack((places, zero), axis=-1))] - bow
    across = places[_taken(np.stack((zero + bow, places), axis=-1))]
    few = _taken(np.stack((zero + 0.9, 0.1 * places), axis=-1), room=3).sum()
    none = _taken(np.stack((places, zero), axis=-1), collects=False).sum()
    return [
        near("reach before the bow", ahead.max(initial=-9.0), 0.12, 2e-3, "m"),
        near("reach behind the bow", -ahead.min(initial=9.0), 0.3, 2e-3, "m"),
        near("to port", across.max(initial=-9.0), side, 2e-3, "m"),
        near("to starboard", -across.min(initial=9.0), side, 2e-3, "m"),
        near("taken with room for three", few, 3, 0, "items"),
        near("taken by a scout", none, 0, 0, "items"),
    ]


def _taken(places: Float64Array, room: int = 10_000, collects: bool = True) -> NDArray[np.bool_]:
    """(item,) which of the items at places in body axes [m] one vessel takes."""
    forager, count, yaw = load_vessel("forager"), len(places), 0.7
    graph = navigation_graph(CHANNEL, PITCH_M, False)
    centres = np.stack((graph.rows, graph.cols), axis=1).astype(np.float64)
    node = np.zeros((1, count), np.int32)
    start = InitialState(
        np.array([count], np.int32),
        np.zeros((1, count, 2)),
        node,
        np.zeros((1, 2)),
        np.zeros((1, 1), np.int32),
    )
    state = start_state(start, centres)
    c, s = np.cos(yaw), np.sin(yaw)
    xy = places @ np.array([[c, s], [-s, c]]) + (5.0, -3.0)
    size = np.array([[0.5 * forager.length_m, 0.5 * forager.beam_m]])
    reach = Reach(np.array([collects]), size, LandGrid(np.zeros((0, 0), np.bool_), PITCH_M), False)
    pose, left = np.array([[[5.0, -3.0, yaw]]]), np.array([[room]], np.int64)
    mouths = mouths_of(Physics(), 1, 0.1).of(1)
    collect_at_mouth(reach, np.ones(1, np.bool_), pose, xy[None], left, state, mouths, np.zeros(1))
    return np.asarray(state.item_node[0] < 0)


def noted(
    simulation: Simulation, vessels: list[Vessel], seconds: float, until_touch: bool = False
) -> PeriodRecord:
    """What a mission notes of a simulation in the basin, for a time, or until the first touch."""
    size = np.array([(0.5 * v.length_m, 0.5 * v.beam_m) for v in vessels])
    scene = simulation.scene
    setup = MonitorSetup(pack_fleet(vessels), size, scene.land, scene.pitch_m, STEP_S)
    shape = (1, len(vessels))
    seen, on = PeriodRecord.of(shape), np.ones(1, np.bool_)
    for _ in range(round(seconds / STEP_S)):
        before = Motion(simulation.vessel_pose, simulation.vessel_velocity)
        simulation.step(round(STEP_S / simulation.step_s))
        tick = Tick(
            before=before,
            after=Motion(simulation.vessel_pose, simulation.vessel_velocity),
            target=np.zeros((*shape, 2)),
            giving_way=np.zeros(shape, np.bool_),
            met=simulation.contact_pose,
            lagged=simulation.thruster_state,
        )
        monitor(setup, seen, on, tick)
        if until_touch and seen.touching.any():
            break
    return seen


@check("touch-speed", "18")
def touch_speed() -> Measures:
    """Foragers without drag run at quays and each other in MuJoCo, at speeds that are known.

    Bow first, obliquely, spinning with a corner ahead, and head on at each other: the fastest
    approach that a mission notes, against the velocity of the point that touches first.
    """
    vessel = dataclasses.replace(dragless(load_vessel("forager")), windage=NO_WINDAGE)
    slant, spin, off = math.radians(60.0), 0.02, EAST_M - 0.5 * vessel.length_m
    along, aside = 0.5 * vessel.length_m, 0.5 * vessel.beam_m
    corner = along * math.cos(slant) + aside * math.sin(slant)  # east of midships
    lever = along * math.sin(slant) - aside * math.cos(slant)  # and north
    ahead, aslant = 0.4 * math.cos(slant), 0.4 * math.sin(slant)
    runs = {
        "bow first": ([[off - 0.21, 8.0, 0.0]], [[0.4, 0.0, 0.0]], 0.4),
        "obliquely": ([[EAST_M - corner - 0.2, 8.0, slant]], [[ahead, aslant, 0.0]], ahead),
        "spinning": ([[EAST_M - corner - 3e-3, 8.0, slant]], [[0.0, 0.0, -spin]], spin * lever),
        "head on": ([[6.0, 8.0, 0.0], [8.3, 8.1, math.pi]], [[0.3, 0, 0], [-0.2, 0, 0]], 0.5),
    }
    found: Measures = []
    for words, (pose, velocity, expected) in runs.items():
        fleet = [vessel] * len(pose)
        simulation = Simulation(build_scene(fleet, navigable=BASIN, pitch_m=PITCH_M))
        simulation.place_vessels(np.array(pose), np.array(velocity))
        fastest = noted(simulation, fleet, 3.0, until_touch=True).impact_mps.max()
        found.append(near_share(words, fastest, expected, 0.01, "m/s"))
    return found


@check("energy-drawn", "19")
def energy_drawn() -> Measures:
    """Every vessel, the forager with 100 items too: 20 s from rest at 0.6 of the largest thrust.

    Energy against momentum theory, T (u + a) with a of T = 2 rho A (u + a) a, over the share of
    the motor's power that does it moored, integrated over the speed of the independent vessel, and
    hotel power. An otter flat out, moored and under way, against its users' power budget, 833.8 W
    (NTNU).
    """
    found: Measures = []
    for name, load in CASES:
        vessel = load_vessel(name)
        ((_, command, _),) = in_commands(vessel, ((0.0, 0.6, 0.6),))
        simulation = Simulation(build_scene([vessel], navigable=BASIN, pitch_m=1e3))
        simulation.load[:], simulation.commands[:] = load, command
        drawn = noted(simulation, [vessel], RIDE_S).work_j[0, 0]
        expected = _drawn(vessel, load, command) if vessel.power else 0.0
        found.append(near_share(case_name(name, load), drawn, expected, 0.01, "J"))
    return [*found, _moored(), _under_way()]


def _under_way() -> Measure:
    otter = load_vessel("otter")
    simulation = Simulation(build_scene([otter], navigable=BASIN, pitch_m=1e3))
    simulation.commands[:] = otter.thruster.command_range[1]
    simulation.step(round(20.0 / simulation.step_s))
    watts = noted(simulation, [otter], 5.0).work_j[0, 0] / 5.0
    return near_share("otter, at 3.09 m/s, flat out", watts, MOORED_W, 5e-3, "W")


def _moored() -> Measure:
    otter = load_vessel("otter")
    full = otter.thruster.command_range[1]
    simulation = Simulation(build_scene([otter], navigable=BASIN, pitch_m=PITCH_M))
    simulation.place_vessels(np.array([EAST_M - 1.0, 8.0, 0.0]))
    simulation.commands[:] = simulation.thruster_state[:] = full
    watts = noted(simulation, [otter], 5.0).work_j[0, 0] / 5.0
    return near_share("otter, moored, flat out", watts, MOORED_W, 5e-3, "W")


def _drawn(vessel: Vessel, load: float, command: float) -> float:
    """Energy of `RIDE_S` from rest [J]."""
    rows = momentum_rows(vessel, ((0.0, command, command),), load=load, seconds=RIDE_S)
    times = STEP_S * np.arange(len(rows))

    power, most = vessel.power, max(map(abs, vessel.thruster.thrust_range))
    assert power is not None
    flow = 1025.0 * math.pi / 4.0 * power.propeller_m**2  # rho A
    share = math.sqrt(most**3 / (2.0 * flow)) / power.motor_w

    def watts(t: float) -> float:
        u = float(np.interp(t, times, rows[:, 3]))
        push = thrust(vessel, -command * math.expm1(-t / vessel.lag_s), u)
        induced = np.roots([2.0 * flow, 2.0 * flow * u, -push]).max()
        return float(2.0 * push * (u + induced) / share + power.hotel_w)

    return float(quad(watts, 0.0, RIDE_S, limit=200, epsabs=1.0)[0])
