"""Vessels on open water under the pilot, one per episode, all with the same order."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import episode_keys
from mjforage.controllers import Pilot
from mjforage.controllers.state import STATE, VesselState
from mjforage.controllers.vessel_model import packed
from mjforage.forcing import Forcing
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Simulation
from mjforage.physics.vessel_models import vessel_model
from mjforage.physics.vessels import Vessel, load_vessel
from mjforage.scenario.scenario import Weather
from tests.mjforage.mission.by_hand import CALM

FloatArray = NDArray[np.float64]

CONTROL_S = 0.1
CURRENT_MPS = 0.3
CORNER_M = 2.0  # before a corner the next leg is ordered
FREE = 1e3  # a limit that no vessel reaches
FORAGER, SCOUT = (packed(vessel_model(load_vessel(name))) for name in ("forager", "scout"))


def blank() -> VesselState:
    """A pilot's memory of one vessel, all 0."""
    state: VesselState = np.zeros(1, STATE)[0]
    return state


def vessel_at(x: float, y: float, yaw: float = 0.0, speed: float = 0.0) -> VesselState:
    """A vessel going ahead at `speed`, without limits and items."""
    s = blank()
    s.x, s.y, s.yaw = x, y, yaw
    s.vx, s.vy = speed * np.cos(yaw), speed * np.sin(yaw)
    s.most_ahead = s.most_astern = s.most_port = s.most_starboard = FREE
    s.item_x = s.item_y = np.nan
    return s


def beam_gusts(current: bool = False) -> Weather:
    """6 m/s of gusty wind to the north, and a current with it."""
    return replace(
        CALM,
        wind_speed_mps=6.0,
        wind_from_deg=180.0,
        gust_intensity=0.15,
        current_speed_mps=CURRENT_MPS if current else 0.0,
        current_to_deg=0.0,
    )


def cross_current() -> Weather:
    return replace(CALM, current_speed_mps=CURRENT_MPS, current_to_deg=0.0)


@dataclass(frozen=True)
class Track:
    """Motion of vessels: poses (tick, episode, 3) and velocities over ground, world axes."""

    pose: FloatArray
    velocity: FloatArray

    def off(self, target: tuple[float, float]) -> FloatArray:
        """(tick, episode) distance from a point [m]."""
        return np.hypot(self.pose[..., 0] - target[0], self.pose[..., 1] - target[1])

    def first_within(self, target: tuple[float, float], radius_m: float) -> FloatArray:
        """(episode,) time of first coming that near [s], infinite if never."""
        near = self.off(target) < radius_m
        return np.where(near.any(axis=0), near.argmax(axis=0) * CONTROL_S, np.inf)


def sail(
    vessel: Vessel,
    yaws: FloatArray,
    target: tuple[float, float],
    seconds: float,
    *,
    stay: bool = False,
    weather: Weather = CALM,
    noise_m: float = 0.0,
    start: tuple[float, float] = (0.0, 0.0),
    load: float = 0.0,
    then: tuple[float, float] | None = None,
) -> Track:
    """Start at rest at each heading [rad], get one order (or one to stay every 10 s), and go.

    `load` items are aboard, of which controllers know nothing. `CORNER_M` before the target the
    order is `then`, if there is one.
    """
    n = yaws.size
    simulation = Simulation(build_scene([vessel]), n)
    pilot, rng = Pilot([vessel_model(vessel)], None, n), np.random.default_rng(5)
    field = Forcing.create(weather, episode_keys(3, np.arange(n)))
    pose = np.zeros((n, 1, 3))
    pose[:, 0, :2], pose[:, 0, 2] = start, yaws
    simulation.place_vessels(pose)
    simulation.load[:] = load
    active, order = np.ones(n, np.bool_), np.full((n, 1), stay)
    to = np.broadcast_to(np.array(target), (n, 1, 2)).copy()
    origin = to if stay else pose[..., :2].copy()
    poses, velocities, turned = [], [], np.zeros(n, np.bool_)
    for tick in range(round(seconds / CONTROL_S)):
        if tick == 0 or (stay and tick % 100 == 0):
            pilot.order(active, origin, to, order)
        t, where = tick * CONTROL_S, simulation.vessel_pose
        if then is not None:
            off = np.hypot(*np.moveaxis(where[:, 0, :2] - np.array(target), -1, 0))
            turning = ~turned & (off < CORNER_M)
            turned |= turning
            pilot.order(turning, to, np.broadcast_to(np.array(then), to.shape), order)
        simulation.vessel_wind[:] = field.wind(t, where[..., :2])
        simulation.vessel_water[:] = field.current(t, where[..., :2])
        seen = where + noise_m * rng.normal(size=where.shape) * (1.0, 1.0, 0.12)
        simulation.commands[:] = pilot.command(active, seen, simulation.vessel_velocity)
        simulation.step()
        poses.append(simulation.vessel_pose[:, 0])
        velocities.append(simulation.vessel_velocity[:, 0])
    return Track(np.array(poses), np.array(velocities))
