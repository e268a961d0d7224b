"""The mission in a current that quays respect: one water for all, and hulls that hold in it."""

from typing import Any

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.mission.moves import Moves
from mjforage.mission.setup import Setup
from mjforage.physics.dynamics.mujoco_dynamics import MujocoDynamics
from mjforage.physics.simulation import Simulation
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario_file import load_scenario

CALM = ("weather.drift_node_per_step=0.0", "weather.noise_node_per_step=0.0")
STREAM = ("weather.current_speed_mps=0.3",)


def holding(preset: str, episodes: int, decisions: int, *overrides: str) -> MujocoDynamics:
    """Vessels that stay where they start, in 0.3 m/s."""
    setup = Setup.of(load_scenario(preset, (*CALM, *STREAM, *overrides)))
    dynamics = MujocoDynamics(setup.graph, setup.fleet, setup.scenario)
    keys = episode_keys(7, np.arange(episodes))
    initial = setup.create_initial_state(keys)
    dynamics.reset(initial, keys, [str(e) for e in range(episodes)])
    shape = initial.agent_node.shape
    still = np.zeros(shape, np.int8)
    moves = Moves(still + np.int8(STAY), initial.agent_node, still, still.astype(np.bool_))
    for step in range(decisions):
        dynamics.advance(np.ones(episodes, np.bool_), np.full(episodes, step + 1, np.int32), moves)
        assert not dynamics._state.collisions.any(), f"decision {step}"
        assert dynamics._state.impact.max() == 0.0
    return dynamics


@pytest.mark.parametrize("preset", ["channels", "open-bay", "comb-port"])
def test_vessels_hold_in_a_current_without_touching(preset: str) -> None:
    """20 fleets over two minutes, the stream from anywhere, quays beside many: none touches, and
    all are within 1 m of their places at the end."""
    dynamics = holding(preset, 20, 12)
    off = dynamics._motion.pose[..., :2] - dynamics._centres_xy[dynamics._state.agent_node]
    assert np.hypot(off[..., 0], off[..., 1]).max() < 1.0


def test_vessels_and_items_with_and_without_bodies_feel_one_water() -> None:
    """In one place at one time: the field's, at hulls, at items, and in active bodies."""
    dynamics = holding("channels", 4, 1, "weather.circulation_mps=0.1")
    simulation, now = dynamics._simulation, dynamics._tick * 0.1
    active = np.ones(4, np.bool_)
    simulation._afloat.q[:, 0] = dynamics._motion.pose[:, 0, :2] + 0.05  # beside a vessel: active
    ticks: Any = dynamics._playing
    ticks._feel(active)
    simulation.step(1)
    field, items = dynamics._forcing, simulation._afloat.q
    np.testing.assert_array_equal(
        simulation.vessel_water, field.current(now, dynamics._motion.pose[..., :2])
    )
    assert np.abs(simulation.item_water).max() > 0.05
    assert isinstance(simulation, Simulation)
    bodies = simulation._bodies
    given = np.argwhere(bodies.item_of >= 0)
    assert len(given) >= 4
    for e, body in given:
        k = bodies.item_of[e, body]
        np.testing.assert_array_equal(bodies.water[e, body], simulation.item_water[e, k])
    afloat = simulation.item_class >= 0
    assert np.abs(field.current(now, items) - simulation.item_water)[afloat].max() < 0.02


def test_a_current_in_a_closed_port_is_refused_before_an_episode_begins() -> None:
    setup = Setup.of(load_scenario("comb-port", STREAM))
    closed = setup.grid.navigable.copy()
    closed[[0, -1]] = closed[:, [0, -1]] = False
    graph = type(setup.graph)(closed, setup.graph.pitch_m, False)
    with pytest.raises(UserError, match=r"current_speed_mps = 0\.3 on a map without water"):
        MujocoDynamics(graph, setup.fleet, setup.scenario)
    assert create_mission(setup, "physics") is not None
