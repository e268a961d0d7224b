"""What a mission notes of hulls: how fast they touch, and what they draw."""

import dataclasses
import math

import numpy as np
from scipy.integrate import quad

from mjforage.physics.dynamics.watch import Harbour, Motion, Tick, Watched, watch
from mjforage.physics.hydrodynamics.parameters import pack_fleet
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.validation.contacts import dragless
from mjforage.physics.validation.finding import Float64Array, Measure, near_share
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.validation.momentum import thrust
from mjforage.physics.validation.shared_runs import CASES, case_name, momentum_rows, ordered
from mjforage.physics.vessels import NO_WINDAGE, Vessel, load_vessel

TICK_S = 0.1
BASIN = np.ones((5, 5), np.bool_)  # 20 x 20 m, its south-west cell around the origin
PITCH_M, EAST_M, WIDE_M = 4.0, 18.0, 1e3  # of a cell, the basin's edge, a cell of open water
FLOW_KGPM = 1025.0 * math.pi / 4.0 * 0.2**2  # rho A of a propeller
MOORED_W = 833.8  # NTNU, power usage of the Otter
RIDE_S = 20.0
SHARE = 0.6


def noted(
    simulation: Simulation, vessels: list[Vessel], seconds: float, until_touch: bool = False
) -> Watched:
    """What a mission notes of a simulation in the basin, for a time, or until the first touch."""
    size = np.array([(0.5 * v.length_m, 0.5 * v.beam_m) for v in vessels])
    framed = np.pad(np.arange(25, dtype=np.int32).reshape(5, 5), 1, constant_values=-1)
    harbour = Harbour(pack_fleet(vessels), size, framed, simulation.scene.pitch_m, TICK_S)
    shape = (1, len(vessels))
    seen, on = Watched.of(shape), np.ones(1, np.bool_)
    for _ in range(round(seconds / TICK_S)):
        before = Motion(simulation.vessel_pose, simulation.vessel_velocity)
        simulation.step(round(TICK_S / simulation.step_s))
        tick = Tick(
            before=before,
            after=Motion(simulation.vessel_pose, simulation.vessel_velocity),
            target=np.zeros((*shape, 2)),
            giving_way=np.zeros(shape, np.bool_),
            water=simulation.vessel_water,
            lagged=simulation.thruster_state,
        )
        watch(harbour, seen, on, tick)
        if until_touch and seen.touching.any():
            break
    return seen


@check("touch-speed", "18", "How fast hulls touch")
def touch_speed() -> Parts:
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
    measures: list[Measure] = []
    for words, (pose, velocity, expected) in runs.items():
        found = _touched(vessel, np.array(pose), np.array(velocity))
        measures.append(near_share(words, found, expected, 0.01, "m/s"))
    return tuple(measures), ()


def _touched(vessel: Vessel, pose: Float64Array, velocity: Float64Array) -> float:
    """Fastest approach at the first touch [m/s]."""
    fleet = [vessel] * len(pose)
    scene = build_scene(fleet, navigable=BASIN, pitch_m=PITCH_M)
    simulation = Simulation(scene, integrator=Integrator.FAST)
    simulation.place_vessels(pose, velocity)
    return float(noted(simulation, fleet, 3.0, until_touch=True).impact_mps.max())


@check("energy-drawn", "19", "What hulls draw from their batteries")
def energy_drawn() -> Parts:
    """Every hull, the forager with 100 items too: 20 s from rest at 0.6 of the largest thrust.

    Energy against momentum theory with the file's efficiency, T (u + a) with a of T = 2 rho A
    (u + a) a, integrated over the speed of the independent hull, and hotel power. A moored otter
    flat out against its users' power budget, 833.8 W (NTNU).
    """
    measures: list[Measure] = []
    for name, load in CASES:
        vessel = load_vessel(name)
        ((_, command, _),) = ordered(vessel, ((0.0, SHARE, SHARE),))
        simulation = Simulation(build_scene([vessel], navigable=BASIN, pitch_m=WIDE_M))
        simulation.load[:], simulation.commands[:] = load, command
        drawn = float(noted(simulation, [vessel], RIDE_S).work_j[0, 0])
        expected = _drawn(vessel, load, command)
        measures.append(near_share(case_name(name, load), drawn, expected, 0.01, "J"))
    otter = load_vessel("otter")
    full = otter.thruster.command_range[1]
    simulation = Simulation(build_scene([otter], navigable=BASIN, pitch_m=PITCH_M))
    simulation.place_vessels(np.array([EAST_M - 1.0, 8.0, 0.0]))
    simulation.commands[:] = simulation.thruster_state[:] = full
    moored = float(noted(simulation, [otter], 5.0).work_j[0, 0]) / 5.0
    measures.append(near_share("otter, moored, flat out", moored, MOORED_W, 5e-3, "W"))
    return tuple(measures), ()


def _drawn(vessel: Vessel, load: float, command: float) -> float:
    """Energy of `RIDE_S` from rest [J]."""
    rows = momentum_rows(vessel, ((0.0, command, command),), load=load, seconds=RIDE_S)
    times = TICK_S * np.arange(len(rows))

    def watts(t: float) -> float:
        push = thrust(vessel, -command * math.expm1(-t / vessel.lag_s))
        u = float(np.interp(t, times, rows[:, 3]))
        induced = np.roots([2.0 * FLOW_KGPM, 2.0 * FLOW_KGPM * u, -push]).max()
        return 2.0 * push * (u + float(induced)) / vessel.power.efficiency + vessel.power.hotel_w

    return float(quad(watts, 0.0, RIDE_S, limit=200, epsabs=1.0)[0])
