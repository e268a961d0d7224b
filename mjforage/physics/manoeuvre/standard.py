"""Standard tests, by analogy with IMO MSC.137(76) and ITTC 7.5-04-02-01, for differential thrust.

Instead of a rudder angle, a test has a mean and a split of the thrust: each side gets
mean +- split, as shares of the largest thrust ahead. Ahead from rest first, then the manoeuvre.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from mjforage.physics.hydrodynamics.conditions import State
from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.thruster import command_for
from mjforage.physics.vessels import Vessel

Steering: TypeAlias = Callable[[float, State], tuple[float, float]]
"""Commands of port and starboard from (time [s], state) on."""

AHEAD_S = 20.0  # of straight, coasting and stopping tests, from rest
APPROACH_S = 15.0  # straight ahead from rest, before a zigzag
ZIGZAG_MEAN, ZIGZAG_SPLIT = 0.2, 0.1  # shares of the largest thrust ahead
TURN_MEAN, TURN_SPLIT = 0.4, 0.2


@dataclass(frozen=True)
class StandardTest:
    """A manoeuvre: its default duration, and its steering."""

    description: str
    duration_s: float
    steering: Callable[[Vessel, float], Steering]  # of vessel and heading at the start [rad]
    marks_s: tuple[float, ...] = ()  # when commands change, whatever the vessel does


def shares(vessel: Vessel, port: float, starboard: float) -> tuple[float, float]:
    """Commands that give these shares of the largest thrust, astern if negative."""
    low, high = vessel.thruster.thrust_range
    p = pack(vessel)
    left, right = (share * (high if share > 0.0 else -low) for share in (port, starboard))
    return float(command_for(p, left)), float(command_for(p, right))


def _turn(side: float) -> Callable[[Vessel, float], Steering]:
    def steering(vessel: Vessel, heading_rad: float) -> Steering:
        turning = shares(vessel, TURN_MEAN - side * TURN_SPLIT, TURN_MEAN + side * TURN_SPLIT)
        return lambda time_s, state: turning

    return steering


def _straight(vessel: Vessel, heading_rad: float) -> Steering:
    ahead = shares(vessel, 1.0, 1.0)
    return lambda time_s, state: ahead if time_s < AHEAD_S else (0.0, 0.0)


def _stop(vessel: Vessel, heading_rad: float) -> Steering:
    ahead, astern = shares(vessel, 1.0, 1.0), shares(vessel, -1.0, -1.0)
    return lambda time_s, state: ahead if time_s < AHEAD_S else astern


def _drift(vessel: Vessel, heading_rad: float) -> Steering:
    return lambda time_s, state: (0.0, 0.0)


class _ZigzagSteering:
    """Split to port until the heading has turned by the angle, then to starboard, and so on."""

    def __init__(self, vessel: Vessel, heading_rad: float, angle_rad: float) -> None:
        self._straight = shares(vessel, ZIGZAG_MEAN, ZIGZAG_MEAN)
        outer, inner = ZIGZAG_MEAN + ZIGZAG_SPLIT, ZIGZAG_MEAN - ZIGZAG_SPLIT
        self._to = {1: shares(vessel, inner, outer), -1: shares(vessel, outer, inner)}
        self._heading, self._angle, self._side = heading_rad, angle_rad, 1

    def __call__(self, time_s: float, state: State) -> tuple[float, float]:
        if time_s < APPROACH_S:
            self._heading = state[2]  # the execute refers to the heading then
            return self._straight
        if self._side * (state[2] - self._heading) >= self._angle:
            self._side = -self._side
        return self._to[self._side]


def _zigzag(angle_deg: float) -> Callable[[Vessel, float], Steering]:
    angle = math.radians(angle_deg)
    return lambda vessel, heading_rad: _ZigzagSteering(vessel, heading_rad, angle)


STANDARD_TESTS = {
    "turning-circle": StandardTest("steady turn to port", 180.0, _turn(1.0)),
    "turning-circle-starboard": StandardTest("steady turn to starboard", 180.0, _turn(-1.0)),
    "zigzag": StandardTest("10/10 zigzag, port first", 120.0, _zigzag(10.0), (APPROACH_S,)),
    "zigzag-20": StandardTest("20/20 zigzag, port first", 120.0, _zigzag(20.0), (APPROACH_S,)),
    "straight": StandardTest(
        "flat out for 20 s from rest, then coasting", 80.0, _straight, (AHEAD_S,)
    ),
    "stop": StandardTest("flat out for 20 s from rest, then full astern", 30.0, _stop, (AHEAD_S,)),
    "drift": StandardTest("thrusters stopped", 120.0, _drift),
}
