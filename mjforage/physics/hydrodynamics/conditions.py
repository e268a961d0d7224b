"""Conditions of a single vessel, and the protocol of anything that moves one."""

import math
from dataclasses import dataclass
from typing import Protocol, TypeAlias

State: TypeAlias = tuple[float, float, float, float, float, float]
"""x, y [m], yaw [rad], surge, sway [m/s] over ground in body axes, yaw rate [rad/s]; midships."""


@dataclass(frozen=True)
class Conditions:
    """Constant current and wind [m/s, east and north, where they flow to], and the start."""

    current_mps: tuple[float, float] = (0.0, 0.0)
    wind_mps: tuple[float, float] = (0.0, 0.0)  # over ground
    heading_rad: float = 0.0
    velocity_mps: tuple[float, float] = (0.0, 0.0)  # at the start, over ground, forward and to port
    yaw_rate_radps: float = 0.0  # at the start

    @property
    def start(self) -> State:
        """State at t = 0: midships at the origin."""
        return (0.0, 0.0, self.heading_rad, *self.velocity_mps, self.yaw_rate_radps)


def to_body(vector: tuple[float, float], yaw_rad: float) -> tuple[float, float]:
    """A vector of the world (east, north) as (forward, to port)."""
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    return c * vector[0] + s * vector[1], c * vector[1] - s * vector[0]


class SimulatedVessel(Protocol):
    """One vessel alone on open water, moved by commands; thrusters are stopped at the start."""

    def step(self, port: float, starboard: float, step_s: float) -> None:
        """Advance by `step_s` under constant commands [rad/s or N, as the vessel has them]."""

    def state(self) -> State:
        """The state now."""
