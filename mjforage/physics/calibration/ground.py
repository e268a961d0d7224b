"""Test basin for a lone vessel that collects items at rest, in MuJoCo, with its pilot and noise."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.graph.navigation import STAY, NavigationGraph, navigation_graph
from mjforage.mission.initial_state import InitialState, nearest_nodes
from mjforage.mission.moves import Moves
from mjforage.physics.dynamics.mujoco_dynamics import MujocoDynamics
from mjforage.scenario.roles import Fleet, Role
from mjforage.scenario.scenario import MapChoice, Physics, Scenario, Sensors, Weather

FloatArray = NDArray[np.float64]

SIDE, PITCH_M, PERIOD_S = 5, 4.0, 10.0  # nodes, and the defaults of a scenario
SENSORS = Sensors(  # of `comb-port-weather`
    position_noise_m=0.1, heading_noise_deg=1.0, camera_noise_m=0.1, camera_fov_deg=360.0
)
_TEAM = {"foragers": Role(count=1, moves=1, radius=1.0, collects=True)}


def basin() -> NavigationGraph:
    """Open water with quays all around; its south-west node has its centre at (0, 0)."""
    return navigation_graph(np.ones((SIDE, SIDE), np.bool_), PITCH_M, False)


@dataclass(frozen=True)
class Trials:
    """Hulls at rest, each alone with its items.

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
    """(trial, item) decision in which each item was taken, from 0; `decisions` if in none.

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
