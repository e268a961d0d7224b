"""Trials of lone vessels that collect items at rest in a basin, in MuJoCo, with pilot and noise.

A vessel starts anywhere where it floats free; items lie beside quays or not.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.graph.navigation import STAY, NavigationGraph, navigation_graph
from mjforage.mission.initial_state import InitialState, nearest_nodes
from mjforage.mission.moves import Moves
from mjforage.physics.dynamics.mujoco_dynamics import MujocoDynamics
from mjforage.physics.vessels import Vessel
from mjforage.scenario.capture import QUAYS, Quays
from mjforage.scenario.roles import Fleet, Role
from mjforage.scenario.scenario import MapChoice, Physics, Scenario, Weather
from mjforage.scenario.sensors import Sensors

FloatArray = NDArray[np.float64]

SIDE, PITCH_M, PERIOD_S = 5, 4.0, 10.0  # nodes, and the defaults of a scenario
SENSORS = Sensors(  # of `comb-port-weather`
    position_noise_m=0.1, heading_noise_deg=1.0, camera_noise_m=0.1, camera_fov_deg=360.0
)
MIDDLE_M = 0.5 * (SIDE - 1) * PITCH_M  # centre of the basin's middle node, on both axes
REST_M = (1.85, 1.9)  # from a node's centre, of the middle of an item that rests at its quay
REACH_M = 1.95  # the same at most, along a quay or without one
FREE_M = 0.12  # around a vessel at first; more than the radius of an item
_TEAM = {"foragers": Role(count=1, moves=1, radius=1.0, collects=True)}


def basin() -> NavigationGraph:
    """Open water with quays all around; its south-west node has its centre at (0, 0)."""
    return navigation_graph(np.ones((SIDE, SIDE), np.bool_), PITCH_M, False)


@dataclass(frozen=True)
class Trials:
    """Vessels at rest, each alone with its items.

    Attributes
    ----------
    pose : (trial, 3) midships [m] and heading [rad]
    node : (trial, 2) centre of the node that the vessel is sent to [m], its own or one beside it
    items : (trial, item, 2) [m], in that node
    """

    pose: FloatArray
    node: FloatArray
    items: FloatArray

    def rows(self, which: NDArray[np.integer] | NDArray[np.bool_]) -> "Trials":
        """Some of them (trial,)."""
        return Trials(self.pose[which], self.node[which], self.items[which])

    @classmethod
    def joined(cls, parts: Sequence["Trials"]) -> "Trials":
        """One after the other."""
        return cls(
            np.concatenate([part.pose for part in parts]),
            np.concatenate([part.node for part in parts]),
            np.concatenate([part.items for part in parts]),
        )


def collected_in(
    vessel: str, trials: Trials, decisions: int, seed: int, sensors: Sensors = SENSORS
) -> NDArray[np.int64]:
    """(trial, item) decision in which each item was collected, from 0; `decisions` if in none.

    Parameters
    ----------
    vessel : name, or path of a TOML file
    seed : of the noise
    sensors : measurement noise of the vessel

    Raises
    ------
    UserError
        If there is no such vessel, or it cannot turn in a node of 4 m.
    """
    graph, (count, items) = basin(), trials.items.shape[:2]
    dynamics = MujocoDynamics(graph, Fleet.of(_TEAM), _scenario(vessel, sensors))
    item_rc = graph.row_column(trials.items)
    begin, target = (
        nearest_nodes(graph.water, graph.row_column(xy[:, None, :2]))
        for xy in (trials.pose, trials.node)
    )
    initial = InitialState(
        n_items=np.full(count, items, np.int32),
        item_rc=item_rc,
        item_node=nearest_nodes(graph.water, item_rc),
        drift_rc=np.zeros((count, 2)),
        agent_node=begin,
    )
    keys, names = episode_keys(seed, np.arange(count)), [f"trial {i}" for i in range(count)]
    state = dynamics.reset(initial, keys, names)
    dynamics.place(trials.pose[:, None])
    found = np.full((count, items), decisions)
    for decision in range(decisions):
        stay = (begin == target) | (decision > 0)
        moves = Moves(
            direction=np.where(stay, STAY, 0).astype(np.int8),
            target=target,
            steps=(~stay).astype(np.int8),
            blocked=np.zeros_like(stay),
        )
        left: NDArray[np.bool_] = np.any(state.item_node >= 0, axis=1)
        state = dynamics.advance(left, np.full(count, decision + 1, np.int32), moves)
        found[(state.collected_by >= 0) & (found == decisions)] = decision
    return found


def _scenario(vessel: str, sensors: Sensors) -> Scenario:
    return Scenario(
        name="calibration",
        map=MapChoice(file="", pitch_m=PITCH_M),
        team=_TEAM,
        period_s=PERIOD_S,
        weather=Weather(drift_node_per_step=0.0, noise_node_per_step=0.0),
        physics=Physics(vessels={"foragers": vessel}, capture="intake"),
        sensors=sensors,
    )


def draw(
    rng: np.random.Generator, vessel: Vessel, quays: Quays, count: int, items: int = 1
) -> Trials:
    """Trials with a vessel anywhere in a node or one beside it, and items in the node.

    Parameters
    ----------
    quays : of `QUAYS`, beside each item
    count : number drawn; those whose vessel would touch a quay or an item are left out
    """
    sides = np.zeros((count, 2))
    for axis in range(QUAYS.index(quays)):
        sides[:, axis] = rng.choice((-1.0, 1.0), count)
    sides = rng.permuted(sides, axis=1)
    node = MIDDLE_M * (1.0 + sides)
    at_quay = sides[:, None] * rng.uniform(*REST_M, (count, items, 2))
    off = np.where(sides[:, None] == 0.0, rng.uniform(-REACH_M, REACH_M, at_quay.shape), at_quay)
    origin = node + PITCH_M * rng.integers(-1, 2, (count, 2))
    midships = origin + 0.5 * PITCH_M * rng.uniform(-1.0, 1.0, (count, 2))
    pose = np.column_stack((midships, rng.uniform(-np.pi, np.pi, count)))
    trials = Trials(pose, node, node[:, None] + off)
    free = _is_afloat(vessel, pose) & ~_touches(vessel, trials)
    return trials.rows(free)


def seen_from_vessel(trials: Trials) -> tuple[FloatArray, FloatArray]:
    """(trial, item) how far each item lies ahead of midships, and to port [m]."""
    apart = trials.items - trials.pose[:, None, :2]
    c, s = np.cos(trials.pose[:, 2:]), np.sin(trials.pose[:, 2:])
    return c * apart[..., 0] + s * apart[..., 1], c * apart[..., 1] - s * apart[..., 0]


def _is_afloat(vessel: Vessel, pose: FloatArray) -> NDArray[np.bool_]:
    """(trial,) whether the whole vessel lies in the basin."""
    c, s = np.abs(np.cos(pose[:, 2])), np.abs(np.sin(pose[:, 2]))
    half_length, half_beam = 0.5 * vessel.length_m, 0.5 * vessel.beam_m
    east = np.abs(pose[:, 0] - MIDDLE_M) + c * half_length + s * half_beam
    north = np.abs(pose[:, 1] - MIDDLE_M) + s * half_length + c * half_beam
    inside: NDArray[np.bool_] = np.maximum(east, north) < 0.5 * SIDE * PITCH_M
    return inside


def _touches(vessel: Vessel, trials: Trials) -> NDArray[np.bool_]:
    """(trial,) whether an item lies against the vessel, or in its mouth."""
    ahead, aside = seen_from_vessel(trials)
    along = np.abs(ahead) < 0.5 * vessel.length_m + FREE_M
    across = np.abs(aside) < 0.5 * vessel.beam_m + FREE_M
    found: NDArray[np.bool_] = np.any(along & across, axis=1)
    return found
