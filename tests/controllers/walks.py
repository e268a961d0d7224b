"""Walks of a crew from node to node, steered by the pilot on the real simulation."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.randomness import episode_keys
from mjforage.controllers import Chart, Pilot
from mjforage.controllers.chart import LandArray
from mjforage.forcing import Forcing
from mjforage.graph_planner.graph.navigation import STAY, NavigationGraph, navigation_graph
from mjforage.mission.moves import MoveRules, Moves
from mjforage.mission.resolver import Corruption, Resolver
from mjforage.physics.dynamics.touch import touches
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Simulation
from mjforage.physics.vessel_models import vessel_model
from mjforage.physics.vessels import Vessel, load_vessel
from mjforage.scenario.maps import load_map
from mjforage.scenario.roles import Fleet, Role
from mjforage.scenario.scenario import Weather
from tests.mjforage.mission.by_hand import CALM

FloatArray = NDArray[np.float64]
NodeArray = NDArray[np.int32]
Record = Callable[[int, Simulation, Pilot, FloatArray], None]

CONTROL_S, PERIOD_S, PITCH_M = 0.1, 10.0, 4.0
ARRIVAL_M = 1.0
STARTS = ((10, 7), (12, 7), (14, 7), (16, 7))

DEFAULT = replace(CALM, drift_node_per_step=0.04)  # comb-port: wind up to 1.9 m/s, no current


def crew() -> list[Vessel]:
    """Two scouts and two foragers."""
    scout, forager = load_vessel("scout"), load_vessel("forager")
    return [scout, scout, forager, forager]


def comb_port() -> NavigationGraph:
    return navigation_graph(load_map("comb_port").navigable, PITCH_M, False)


@dataclass
class Outcome:
    """Outcome of a batch of walks."""

    moves: NDArray[np.int64]  # (vessel,) decisions to move
    arrived: NDArray[np.int64]  # (vessel,) of those
    impacts: list[tuple[int, int, int, float]] = field(default_factory=list)
    """Of each period and vessel that touched: period, episode, vessel, fastest approach [m/s]."""
    late: list[tuple[int, int, int]] = field(default_factory=list)  # period, episode, vessel

    @property
    def share(self) -> FloatArray:
        """(vessel,) share of the moves that arrived."""
        return np.asarray(self.arrived / self.moves)

    @property
    def speeds(self) -> FloatArray:
        """(impact,) of these, the fastest approaches [m/s]."""
        return np.array([impact[3] for impact in self.impacts])


@kernel
def _touches(
    pose: FloatArray,
    velocity: FloatArray,
    size: FloatArray,
    land: LandArray,
    pitch_m: float,
    touching: NDArray[np.bool_],
    closing: FloatArray,
) -> None:
    """`touches` of every episode."""
    for e in range(pose.shape[0]):
        touches(pose[e], velocity[e], size, land, pitch_m, touching[e], closing[e])


def crowding(
    graph: NavigationGraph,
    nodes: NodeArray,
    goal: NodeArray,
    strides: NDArray[np.int64],
    rng: np.random.Generator,
) -> FloatArray:
    """Preferences of agents that are all drawn to one node of their episode."""
    out = np.empty((*nodes.shape, 9))
    for d in range(9):
        end = nodes.copy()
        for step in range(int(strides.max()) if d != STAY else 0):
            following = graph.neighbours[end, d]
            end = np.where((following >= 0) & (step < strides), following, end).astype(np.int32)
        nearer = -graph.distances[end, goal[:, None]]
        out[..., d] = np.where((end == nodes) & (d != STAY), -1e9, nearer)
    return out + 0.3 * rng.random(out.shape)


class Walk:
    """A batch of crews on one map; `vessels` are scouts (two nodes a decision), then foragers."""

    def __init__(
        self,
        graph: NavigationGraph,
        vessels: Sequence[Vessel],
        starts: Sequence[tuple[int, int]] = STARTS,
        *,
        scouts: int = 2,
        episodes: int = 8,
        weather: Weather = DEFAULT,
        noise: tuple[float, float] = (0.0, 0.0),
        seed: int = 0,
    ) -> None:
        v = len(vessels)
        self.graph, self.episodes, self.noise = graph, episodes, noise
        self.rng, self.keys = np.random.default_rng(seed), episode_keys(seed, np.arange(episodes))
        roles = {
            "scouts": Role(count=scouts, moves=2, radius=4.0, collects=False),
            "foragers": Role(count=v - scouts, moves=1, radius=1.0, collects=True),
        }
        self.fleet = Fleet.of(roles)
        free = Corruption(np.zeros(v))
        self.resolver = Resolver(graph, self.fleet, MoveRules(stay=True, shorten=True), free)
        scene = build_scene(vessels, navigable=graph.navigable, pitch_m=graph.pitch_m)
        self.simulation = Simulation(scene, episodes)
        self.chart = Chart(graph.navigable, graph.pitch_m)
        self.pilot = Pilot([vessel_model(vessel) for vessel in vessels], self.chart, episodes)
        self.field = Forcing.create(weather, self.keys)
        self.size = np.array([[0.5 * vessel.length_m, 0.5 * vessel.beam_m] for vessel in vessels])
        self.centres = graph.metres(np.stack((graph.rows, graph.cols), axis=1).astype(np.float64))
        first = [graph.node_of_cell[rc] for rc in starts]
        self.node: NodeArray = np.tile(first, (episodes, 1)).astype(np.int32)
        self.goal = self.rng.integers(len(graph), size=episodes).astype(np.int32)
        yaw = self.rng.uniform(-np.pi, np.pi, (episodes, v, 1))
        self.simulation.place_vessels(np.concatenate((self.centres[self.node], yaw), axis=2))
        self.touching, self.closing = np.zeros((episodes, v), np.bool_), np.zeros((episodes, v))
        self.ticks = 0

    def decide(self, period: int, crowded: bool) -> Moves:
        """Resolve random preferences, or those of a crowd."""
        shape = self.node.shape
        preferences = self.rng.random((*shape, 9))
        if crowded:
            other = self.rng.integers(len(self.graph), size=self.episodes)
            again = self.rng.random(self.episodes) < 0.08
            self.goal = np.where(again, other, self.goal).astype(np.int32)
            strides = self.fleet.moves
            preferences = crowding(self.graph, self.node, self.goal, strides, self.rng)
        return self.resolver(
            np.ones(self.episodes, np.bool_),
            preferences,
            self.node,
            np.full(shape, np.inf),
            np.zeros((self.episodes, len(self.graph)), np.int16),
            np.full(self.episodes, period + 1, np.int32),
            self.keys,
        )

    def tick(self) -> FloatArray:
        """One control step; (episode, vessel) speed of its touches [m/s], NaN for none."""
        simulation = self.simulation
        pose, velocity = simulation.vessel_pose, simulation.vessel_velocity
        t = self.ticks * CONTROL_S
        simulation.vessel_wind[:] = self.field.wind(t, pose[..., :2])
        simulation.vessel_water[:] = self.field.current(t, pose[..., :2])
        if any(self.noise):
            sigma = (self.noise[0], self.noise[0], self.noise[1])
            pose = pose + self.rng.normal(size=pose.shape) * sigma
        active = np.ones(self.episodes, np.bool_)
        simulation.commands[:] = self.pilot.command(active, pose, velocity)
        simulation.step(round(CONTROL_S / simulation.step_s))
        self.ticks += 1
        _touches(
            simulation.vessel_pose,
            velocity,
            self.size,
            self.chart.land,
            self.graph.pitch_m,
            self.touching,
            self.closing,
        )
        return np.where(self.touching, self.closing, np.nan)

    def run(self, periods: int, *, crowded: bool = False, record: Record | None = None) -> Outcome:
        """Walk, and count what arrived in time and what touched."""
        v = self.node.shape[1]
        outcome = Outcome(np.zeros(v, np.int64), np.zeros(v, np.int64))
        for period in range(periods):
            moves = self.decide(period, crowded)
            target, stay = self.centres[moves.target], moves.direction == STAY
            active = np.ones(self.episodes, np.bool_)
            self.pilot.order(active, self.centres[self.node], target, stay)
            arrived, fastest = np.zeros_like(stay), np.full(stay.shape, np.nan)
            for _ in range(round(PERIOD_S / CONTROL_S)):
                if record is not None:
                    record(period, self.simulation, self.pilot, target)
                fastest = np.fmax(fastest, self.tick())
                off = self.simulation.vessel_pose[..., :2] - target
                arrived |= np.hypot(off[..., 0], off[..., 1]) < ARRIVAL_M
            for e, i in np.argwhere(~np.isnan(fastest)):
                outcome.impacts.append((period, int(e), int(i), float(fastest[e, i])))
            outcome.moves += (~stay).sum(axis=0)
            outcome.arrived += (~stay & arrived).sum(axis=0)
            late = np.argwhere(~stay & ~arrived)
            outcome.late += [(period, int(e), int(i)) for e, i in late]
            self.node = np.where(arrived, moves.target, self._held()).astype(np.int32)
        return outcome

    def _held(self) -> NodeArray:
        """(episode, vessel) node that holds each vessel, or the one before if it is over a quay."""
        rc = np.rint(self.graph.row_column(self.simulation.vessel_pose[..., :2])).astype(np.int64)
        rows, cols = self.graph.shape
        cells = self.graph.node_of_cell
        held = cells[rc[..., 0].clip(0, rows - 1), rc[..., 1].clip(0, cols - 1)]
        return np.where(held >= 0, held, self.node).astype(np.int32)
