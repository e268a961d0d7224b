"""Load test of the physics: a fleet driven at random through the default port.

Two scouts, two foragers and 75 items, under wind and changing commands, so that vessels and items
lie against quays.
"""

import numpy as np

from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.physics.scene import Scene, build_scene
from mjforage.physics.simulation.integrators import Integrator
from mjforage.physics.simulation.simulation import Simulation
from mjforage.physics.vessels import load_vessel
from mjforage.scenario.maps import load_map

FLEET = ("scout", "scout", "forager", "forager")
ITEMS, BODIES, PITCH_M, STEP_S = 75, 8, 4.0, 0.1
CONTROL_S = 5.0  # commands change this often
WIND_MPS = (1.5, 1.0)


def port_scene() -> Scene:
    """The default port with its fleet and items."""
    navigable = load_map("comb_port").navigable
    vessels = [load_vessel(name) for name in FLEET]
    return build_scene(vessels, navigable=navigable, pitch_m=PITCH_M, items=BODIES)


def port_simulation(
    scene: Scene, integrator: Integrator, simulations: int, seed: int = 0
) -> Simulation:
    """Vessels and items at random nodes of the default port, under wind."""
    graph = navigation_graph(load_map("comb_port").navigable, PITCH_M, False)
    rng = np.random.default_rng(seed)
    nodes = np.stack(
        [rng.permutation(len(graph))[: len(FLEET) + ITEMS] for _ in range(simulations)]
    )
    xy = graph.metres(np.stack((graph.rows[nodes], graph.cols[nodes]), axis=-1).astype(float))
    pose = np.zeros((simulations, len(FLEET), 3))
    pose[..., :2], pose[..., 2] = xy[:, : len(FLEET)], rng.uniform(0, 6.28, pose.shape[:2])
    simulation = Simulation(scene, simulations, integrator=integrator, step_s=STEP_S, items=ITEMS)
    simulation.place_vessels(pose)
    items = xy[:, len(FLEET) :] + rng.uniform(-1, 1, (simulations, ITEMS, 2))
    simulation.place_items(items, rng.integers(0, len(scene.classes), (simulations, ITEMS)))
    simulation.vessel_wind[:] = simulation.item_wind[:] = WIND_MPS
    return simulation


def drive(simulation: Simulation, seconds: float, seed: int = 0) -> None:
    """Run under commands that change at random every `CONTROL_S`."""
    rng = np.random.default_rng(seed)
    low, high = simulation.model.actuator_ctrlrange.T.reshape(2, -1, 2)
    for _ in range(max(1, round(seconds / CONTROL_S))):
        share = rng.uniform(-0.3, 1.0, simulation.commands.shape)
        simulation.commands[:] = np.where(share > 0, share * high, -share * low)
        simulation.step(round(CONTROL_S / simulation.step_s))
