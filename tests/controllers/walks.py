"""Random legal walks of a crew on a map, steered by the pilot on the real simulation."""

import dataclasses
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers import Chart, Helm, Pilot
from controllers.boxes import box_gap
from controllers.chart import quay_gap
from controllers._compiled import kernel
from graph_planner.fleet import Fleet, Role
from graph_planner.moves import Corruption, MoveRules, Resolver
from graph_planner.navigation import NavigationGraph, STAY
from graph_planner.randomness import episode_keys
from mjforage.helm import helm_of
from mjforage.scene import build_scene
from mjforage.simulation import Simulation
from mjforage.vessels import Vessel, load_vessel
from mjforage.weather.field import Field
from mjforage.weather.settings import WeatherSettings

FloatArray = NDArray[np.float64]
CONTROL_S, PERIOD_S = 0.1, 10.0
ARRIVAL_M = 1.0
NEAR_M = 0.25


@kernel
def closing_speeds(
    pose: FloatArray, velocity: FloatArray, size: FloatArray, land: NDArray[np.bool_], pitch: float
) -> FloatArray:
    """(episode, vessel) fastest approach [m/s] to anything within `NEAR_M`."""
    out = np.zeros(pose.shape[:2])
    h = 0.01
    for e in range(pose.shape[0]):
        for i in range(pose.shape[1]):
            x, y, a = pose[e, i]
            vx, vy, r = velocity[e, i]
            c, s, cn, sn = math.cos(a), math.sin(a), math.cos(a + h * r), math.sin(a + h * r)
            l, b = size[i]
            now = quay_gap(land, pitch, x, y, c, s, l, b, 1.0)
            then = quay_gap(land, pitch, x + h * vx, y + h * vy, cn, sn, l, b, 1.0)
            if now < NEAR_M:
                out[e, i] = max(out[e, i], (now - then) / h)
            for j in range(pose.shape[1]):
                if j == i:
                    continue
                dx, dy, q = pose[e, j, 0] - x, pose[e, j, 1] - y, pose[e, j, 2]
                if dx * dx + dy * dy > 25.0:
                    continue
                ux, uy, w = velocity[e, j]
                now = box_gap(dx, dy, c, s, l, b, math.cos(q), math.sin(q), size[j, 0], size[j, 1])
                then = box_gap(dx + h * (ux - vx), dy + h * (uy - vy), cn, sn, l, b,
                    math.cos(q + h * w), math.sin(q + h * w), size[j, 0], size[j, 1])
                if now < NEAR_M:
                    out[e, i] = max(out[e, i], (now - then) / h)
    return out


@dataclass
class Outcome:
    """What happened in a batch of walks."""

    moves: NDArray[np.int64]  # (vessel,) decisions other than to stay
    arrived: NDArray[np.int64]  # (vessel,) of those
    impacts_mps: list[float]  # normal speed at each new contact
    where: list[tuple[int, int, int, float]]  # (period, episode, vessel, speed)
    late: list[tuple[int, int, int]]


def crowd(
    graph: NavigationGraph, nodes: NDArray[np.int32], goal: NDArray[np.int32], rng: np.random.Generator,
    strides: NDArray[np.int64],
) -> FloatArray:
    """Preferences of agents that all want to be at one node of their episode."""
    out = np.full((*nodes.shape, 9), -1e9)
    for d in range(9):
        end = nodes.copy()
        if d != STAY:
            for k in range(int(strides.max())):
                following = graph.neighbours[end, d]
                end = np.where((following >= 0) & (k < strides), following, end)
        far = graph.distances[end, goal[:, None]]
        out[..., d] = np.where((end == nodes) & (d != STAY), -1e9, -far)
    return out + 0.3 * rng.random(out.shape)


def walk(
    graph: NavigationGraph,
    vessels: list[Vessel],
    starts: list[tuple[int, int]],
    *,
    episodes: int = 16,
    periods: int = 30,
    crowded: bool = False,
    weather: WeatherSettings | None = None,
    noise: tuple[float, float] = (0.0, 0.0),
    seed: int = 0,
    helms: list[Helm] | None = None,
    record=None,
) -> Outcome:
    """Let crews walk: `vessels` are scouts (two nodes per decision) unless named forager."""
    v = len(vessels)
    collects = np.array(["forager" in vessel.name or i >= 2 for i, vessel in enumerate(vessels)])
    roles = {
        "scouts": Role(count=int((~collects).sum()), moves=2, radius=4.0, collects=False),
        "foragers": Role(count=int(collects.sum()), moves=1, radius=1.0, collects=True),
    }
    fleet = Fleet.of(roles)
    resolver = Resolver(graph, fleet, MoveRules(stay=True, shorten=True), Corruption(np.zeros(v)))
    simulation = Simulation(
        build_scene(vessels, navigable=graph.navigable, pitch_m=graph.pitch_m), episodes
    )
    chart = Chart(graph.navigable, graph.pitch_m)
    pilot = Pilot(helms or [helm_of(vessel) for vessel in vessels], chart, episodes)
    rng, keys = np.random.default_rng(seed), episode_keys(seed, np.arange(episodes))
    field = Field.create(weather or WeatherSettings(), keys)
    node = np.tile([graph.node_of_cell[rc] for rc in starts], (episodes, 1)).astype(np.int32)
    rc = np.stack((graph.rows, graph.cols), axis=1).astype(float)
    centres = graph.metres(rc)
    pose = np.concatenate((centres[node], rng.uniform(-3, 3, (episodes, v, 1))), axis=2)
    simulation.place_vessels(pose)
    active = np.ones(episodes, bool)
    force = simulation.engine.bind("qfrc_constraint")[:, : 3 * v].reshape(episodes, v, 3)
    size = np.array([[0.5 * vessel.length_m, 0.5 * vessel.beam_m] for vessel in vessels])
    touching = np.zeros((episodes, v), bool)
    result = Outcome(np.zeros(v, int), np.zeros(v, int), [], [], [])
    goal = rng.integers(len(graph), size=episodes).astype(np.int32)
    t = 0.0
    for period in range(periods):
        if crowded:
            redraw = rng.random(episodes) < 0.08
            goal = np.where(redraw, rng.integers(len(graph), size=episodes), goal).astype(np.int32)
            preferences = crowd(graph, node, goal, rng, fleet.moves)
        else:
            preferences = rng.random((episodes, v, 9))
        moves = resolver(active, preferences, node, np.full((episodes, v), np.inf),
            np.zeros((episodes, len(graph)), np.int16), np.full(episodes, period + 1, np.int32), keys)
        target, stay = centres[moves.target], moves.direction == STAY
        pilot.order(active, centres[node], target, stay)
        arrived = np.zeros((episodes, v), bool)
        for _ in range(round(PERIOD_S / CONTROL_S)):
            measured = simulation.vessel_pose
            velocity = simulation.vessel_velocity
            speeds = closing_speeds(measured, velocity, size, chart.land, graph.pitch_m)
            if record is not None:
                record(period, t, measured, velocity, target, stay, pilot)
            if any(noise):
                measured = measured + rng.normal(size=measured.shape) * [noise[0], noise[0], noise[1]]
            simulation.vessel_wind[:] = field.wind(t, simulation.vessel_pose[..., :2])
            simulation.vessel_water[:] = field.current(t, simulation.vessel_pose[..., :2])
            simulation.commands[:] = pilot.command(active, measured, velocity)
            simulation.step(round(CONTROL_S / simulation.step_s))
            t += CONTROL_S
            now = (force != 0.0).any(axis=2)
            for e, i in zip(*np.nonzero(now & ~touching)):
                result.impacts_mps.append(float(speeds[e, i]))
                result.where.append((period, int(e), int(i), float(speeds[e, i])))
            touching = now
            xy = simulation.vessel_pose[..., :2]
            arrived |= np.hypot(*np.moveaxis(xy - target, -1, 0)) < ARRIVAL_M
        moving = ~stay
        result.moves += moving.sum(axis=0)
        result.arrived += (moving & arrived).sum(axis=0)
        result.late += [(period, int(e), int(i)) for e, i in zip(*np.nonzero(moving & ~arrived))]
        cells = np.rint(graph.row_column(simulation.vessel_pose[..., :2])).astype(int)
        held = graph.node_of_cell[cells[..., 0].clip(0, graph.shape[0] - 1), cells[..., 1].clip(0, graph.shape[1] - 1)]
        node = np.where(arrived, moves.target, np.where(held >= 0, held, node)).astype(np.int32)
    return result
