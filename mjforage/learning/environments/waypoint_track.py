"""Core of `Waypoint-v0`: one vessel on open water in weather, and its waypoints."""

import numpy as np
from numpy.typing import NDArray

from mjforage.forcing import Forcing
from mjforage.physics.scaled_vessels import deviations
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Simulation
from mjforage.physics.vessels import Vessel
from mjforage.scenario.scenario import Spread, Weather

TICK_S = 0.1  # controllers run at 10 Hz
NEAREST_M, FARTHEST_M = 4.0, 12.0  # from one waypoint to the next: one to three nodes
REACHED_M = 1.0  # from a waypoint's centre, as a decision's arrival has it

FloatArray = NDArray[np.float64]


class WaypointTrack:
    """A vessel and its waypoints.

    Attributes
    ----------
    pose, velocity : (3,) x, y [m], yaw [rad] of midships, and over ground in world axes
    waypoints : (waypoint, 2) [m]
    reached : how many of them have been reached
    """

    def __init__(self, vessel: Vessel, weather: Weather, spread: Spread, waypoints: int) -> None:
        self.vessel, self._weather, self._spread, self._count = vessel, weather, spread, waypoints
        self.simulation = Simulation(build_scene([vessel]), step_s=TICK_S)

    def start(self, random: np.random.Generator) -> None:
        """Draw waypoints, weather and heading; the vessel is at the origin, at rest."""
        reach = random.uniform(NEAREST_M, FARTHEST_M, self._count)
        bearing = random.uniform(-np.pi, np.pi, self._count)
        legs = reach[:, None] * np.stack((np.cos(bearing), np.sin(bearing)), axis=1)
        self.waypoints: FloatArray = np.cumsum(legs, axis=0)
        keys = random.integers(0, 1 << 63, 1).astype(np.uint64)
        self._forcing = Forcing.create(self._weather, keys)
        self.simulation.reset()
        self.simulation.commands[:] = 0.0
        self.simulation.thruster_state[:] = 0.0
        self.simulation.spread[:] = deviations(self._spread, 1, keys)
        self.simulation.place_vessels(np.array([0.0, 0.0, random.uniform(-np.pi, np.pi)]))
        self.reached, self._ticks = 0, 0
        self._read()

    def _read(self) -> None:
        self.pose = self.simulation.vessel_pose[0, 0].copy()
        self.velocity = self.simulation.vessel_velocity[0, 0].copy()
        here, now = self.pose[None, None, :2], self._ticks * TICK_S
        self.wind, self.current = (each[0, 0] for each in self._forcing.at(now, here))

    @property
    def target(self) -> FloatArray:
        """(2,) the waypoint to go to; the last one once all are reached [m]."""
        return np.asarray(self.waypoints[min(self.reached, len(self.waypoints) - 1)])

    @property
    def following(self) -> FloatArray:
        """(2,) the waypoint after it [m]."""
        return np.asarray(self.waypoints[min(self.reached + 1, len(self.waypoints) - 1)])

    @property
    def distance_m(self) -> float:
        """Distance from midships to the waypoint."""
        return float(np.hypot(*(self.target - self.pose[:2])))

    @property
    def over(self) -> bool:
        """True if all waypoints have been reached."""
        return self.reached == len(self.waypoints)

    def tick(self, port: float, starboard: float) -> tuple[float, bool]:
        """A tenth of a second under commands [rad/s or N].

        Returns: metres that the waypoint has come nearer, and whether it has been reached.
        """
        before, simulation = self.distance_m, self.simulation
        simulation.vessel_wind[0, 0], simulation.vessel_water[0, 0] = self.wind, self.current
        simulation.commands[0, 0] = port, starboard
        simulation.step(1)
        self._ticks += 1
        self._read()
        gain, there = before - self.distance_m, self.distance_m <= REACHED_M
        self.reached += there and not self.over
        return gain, there
