"""Speeds on a device: fleets of hulls, controllers and items (`DeviceFleet`), and environments."""

import time

import numpy as np

from mjforage.bench.running import Progress, Rate
from mjforage.controllers import Chart
from mjforage.forcing import LEEWAY
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.learning.environments.waypoint_vector import WaypointVectorEnv
from mjforage.physics.device_fleet import DeviceFleet
from mjforage.physics.device_hulls import DeviceHulls
from mjforage.physics.port_drive import FLEET, ITEMS, PITCH_M, WIND_MPS
from mjforage.physics.scene import build_scene
from mjforage.physics.vessels import load_vessel
from mjforage.scenario.maps import load_map

BATCHES = {"cuda": (1024, 4096, 16384), "warp-cpu": (16,)}
TICKS, ORDERS_TICKS = 400, 100  # of a measurement, and from orders to orders
STEPS_OF_A_SLICE = 20
UNIT = "fleet steps of 0.1 s per second (4 vessels steered, 75 drifting items)"


STEPS = "environment steps of 0.5 s per second (one vessel, observed and steered by thrusts)"


def port_fleet(
    episodes: int, items: int = ITEMS, seed: int = 0, device: str = "cuda"
) -> DeviceFleet:
    """Fleets and items at random nodes of the default port, under orders and wind."""
    water = load_map("comb_port").navigable
    graph, rng = navigation_graph(water, PITCH_M, False), np.random.default_rng(seed)
    vessels = [load_vessel(name) for name in FLEET]
    scene = build_scene(vessels, navigable=water, pitch_m=PITCH_M, items=0)
    fleet = DeviceFleet(scene, Chart(graph.navigable, PITCH_M), episodes, items, device)
    centres = graph.metres(np.stack((graph.rows, graph.cols), axis=1).astype(np.float64))
    nodes = np.stack([rng.permutation(len(graph))[: len(FLEET)] for _ in range(episodes)])
    pose = np.zeros((episodes, len(FLEET), 3))
    pose[..., :2], pose[..., 2] = centres[nodes], rng.uniform(0.0, 6.28, nodes.shape)
    fleet.place(pose)
    afloat = fleet.afloat
    afloat.q[:] = centres[rng.integers(0, len(graph), (episodes, items))]
    afloat.q[:] += rng.uniform(-1.0, 1.0, afloat.q.shape)
    afloat.kind[:] = rng.integers(0, len(afloat.kinds), afloat.kind.shape)
    afloat.wind[:], afloat.v[:] = WIND_MPS, LEEWAY * np.array(WIND_MPS)
    fleet.send()
    give_orders(fleet, rng)
    return fleet


def give_orders(fleet: DeviceFleet, rng: np.random.Generator) -> None:
    """Send every vessel some metres from where it is."""
    fleet.fetch()
    origin = fleet.pose[..., :2].copy()
    target = origin + rng.choice((-PITCH_M, 0.0, PITCH_M), origin.shape)
    fleet.pilot.order(fleet.active, origin, target, np.zeros(origin.shape[:2], np.bool_))
    fleet.send()


def speeds(device: str, progress: Progress = lambda key: None) -> dict[str, Rate]:
    """Measure batches on "cuda" or "warp-cpu"; first ticks and steps, which compile, do not count.

    Raises `UserError` if there is no such device.
    """
    found = {}
    for episodes in BATCHES[device]:
        progress(key := f"device_fleets_{episodes}")
        found[key] = _fleets(device, episodes)
        progress(key := f"device_waypoints_{episodes}")
        found[key] = _waypoints(device, episodes)
    return found


def _fleets(device: str, episodes: int) -> Rate:
    fleet, rng, rates = port_fleet(episodes, device=device), np.random.default_rng(1), []
    fleet.run(2)
    for _ in range(TICKS // ORDERS_TICKS):
        give_orders(fleet, rng)
        started = time.perf_counter()
        fleet.run(ORDERS_TICKS)
        rates.append(episodes * ORDERS_TICKS / (time.perf_counter() - started))
    return _rate(rates, UNIT, fleet.hulls)


def _waypoints(device: str, envs: int) -> Rate:
    env = WaypointVectorEnv(envs, device=device)
    seen, _ = env.reset(seed=0)
    rates = []
    for _ in range(1 + TICKS // ORDERS_TICKS):
        started = time.perf_counter()
        for _ in range(STEPS_OF_A_SLICE):
            seen, *_ = env.step(seen[:, :2])
        env.wait()
        rates.append(envs * STEPS_OF_A_SLICE / (time.perf_counter() - started))
    return _rate(rates[1:], STEPS, env.hulls)


def _rate(rates: list[float], unit: str, hulls: DeviceHulls) -> Rate:
    """The median and the best, and what an episode takes on the device."""
    kilobytes = f", {hulls.memory_bytes / 1e3:.3g} kB of memory each"
    return Rate(float(np.median(rates)), max(rates), unit + kilobytes)
