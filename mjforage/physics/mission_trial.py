"""A short mission with known answers: two hulls that no pilot steers, before the wind, one laden.

The wind blows from right astern, so a hull keeps its heading, and its speed ahead follows
m u' = a (W - u)^2 - d u - k u^2 (Blendermann's load, and drag): mass m and drag k are those of what
was aboard when the decision began.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mjforage.base.randomness import UInt64Array, episode_keys
from mjforage.controllers import Pilot
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.mission.dynamics import Transition
from mjforage.mission.initial_state import InitialState
from mjforage.mission.moves import Moves
from mjforage.mission.setup import Setup
from mjforage.physics.dynamics.mujoco_dynamics import MujocoDynamics
from mjforage.physics.dynamics.ticks import CONTROL_S
from mjforage.physics.vessel_checks import Measure, at_most
from mjforage.physics.vessels import Vessel, load_vessel
from mjforage.scenario.debris import AIR_DENSITY_KGPM3
from mjforage.scenario.roles import Role
from mjforage.scenario.scenario import Items, MapChoice, Physics, Scenario, Weather

WIND_MPS, PERIOD_S, DECISIONS, FINE_S = 10.0, 10.0, 3, 0.01
ITEMS = 100  # in the node of the hull that collects, aboard from the end of the first decision on
WATER = np.ones((5, 60), np.bool_)  # (row, column)
OFF_M, OFF_J = 2e-3, 0.1  # at most


class _Idle(Pilot):
    """A pilot that takes no orders: its thrusters stand still."""

    def order(self, *orders: object) -> None:
        """Take none."""


class UnsteeredDynamics(MujocoDynamics):
    """Dynamics in MuJoCo whose pilots take no orders."""

    def reset(self, initial: InitialState, keys: UInt64Array, names: Sequence[str]) -> Transition:
        """Start a batch of episodes and return their state at step 0."""
        state = super().reset(initial, keys, names)
        self._pilot = _Idle(self._models, self._chart, keys.size, CONTROL_S)
        return state


def _setup(name: str) -> Setup:
    """Two vessels of one name or file, of which the second collects, far from each other."""
    role = Role(count=1, moves=1, radius=1.0, collects=False)
    pitch_m = max(4.0, 4.0 * load_vessel(name).length_m)
    scenario = Scenario(
        name="trial",
        map=MapChoice("water", pitch_m=pitch_m, starts=((0, 1), (4, 1))),
        team={"empty": role, "laden": replace(role, collects=True)},
        horizon=DECISIONS,
        period_s=PERIOD_S,
        items=Items(mean=ITEMS, std=0.0),
        weather=Weather(noise_node_per_step=0.0, wind_speed_mps=WIND_MPS, wind_from_deg=270.0),
        physics=Physics(vessels={"empty": name, "laden": name}, items="graph"),
    )
    return Setup.of(scenario, WATER)


def _played(setup: Setup) -> Transition:
    """The state after the decisions."""
    dynamics = UnsteeredDynamics(setup.graph, setup.fleet, setup.scenario)
    keys, on = episode_keys(0, np.arange(1)), np.ones(1, np.bool_)
    initial = setup.create_initial_state(keys)
    node = np.full_like(initial.item_node, initial.agent_node[0, 1])
    rc = np.stack((setup.graph.rows[node], setup.graph.cols[node]), axis=-1).astype(np.float64)
    state = dynamics.reset(replace(initial, item_node=node, item_rc=rc), keys, ["0"])
    still = np.zeros((1, 2), np.int8)
    for step in range(1, DECISIONS + 1):
        moves = Moves(still + np.int8(STAY), state.agent_node.copy(), still, still > 0)
        dynamics.advance(on, np.full(1, step, np.int32), moves)
    return state


def way_before_wind(vessel: Vessel, aboard: Sequence[float]) -> float:
    """Way [m] from rest with so many items aboard in each decision, by the midpoint rule."""
    wind, x, u, h = vessel.windage, 0.0, 0.0, FINE_S
    air = 0.5 * AIR_DENSITY_KGPM3 * wind.area_front_m2 * wind.cdl_stern
    for items in aboard:
        mass = vessel.mass_kg + items * vessel.load.mass_per_item_kg + vessel.added_mass_surge_kg
        drag = vessel.quadratic_surge + items * vessel.load.drag_per_item

        def gain(u: float, mass: float = mass, drag: float = drag) -> float:
            return (air * (WIND_MPS - u) ** 2 - vessel.linear_surge * u - drag * u * u) / mass

        for _ in range(round(PERIOD_S / h)):
            middle = u + 0.5 * h * gain(u)
            x, u = x + h * middle, u + h * gain(middle)
    return x


def mission_measures(name: str) -> list[Measure]:
    """Ways and energy of a vessel, by name or file, in the mission.

    Raises `UserError` if there is no such vessel, or the simulation becomes unstable.
    """
    vessel, setup, found = load_vessel(name), _setup(name), []
    state, pitch_m = _played(setup), setup.graph.pitch_m
    idle_j = (vessel.power.hotel_w if vessel.power else 0.0) * PERIOD_S * DECISIONS
    for agent, items in enumerate((0, ITEMS)):
        way = way_before_wind(vessel, (0, *[items] * (DECISIONS - 1)))
        gone = pitch_m * np.array([state.agent_rc[0, agent, 1] - 1.0, state.distance[0, agent]])
        label = f"mission, {items} items aboard, before a wind of {WIND_MPS:g} m/s"
        energy = abs(state.work[0, agent] - idle_j)
        found += [
            at_most(f"{label}: way, off wind and drag", np.abs(gone - way).max(), OFF_M, "m"),
            at_most(f"{label}: energy, off the hotel's", energy, OFF_J, "J"),
        ]
    return found
