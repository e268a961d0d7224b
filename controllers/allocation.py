"""Thrust allocation to two fixed thrusters, yaw before surge, and the inverse of their curve."""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.angles import clipped
from mjforage.controllers.propulsion import moored_thrust, thrust_under_way
from mjforage.controllers.vessel_model import ModelRecord

LEAD = 0.5  # lag that is left of the thrusters' own


@kernel
def allocate(
    p: ModelRecord,
    surge: float,
    moment: float,
    speed: float,
    rate: float,
    port_loss: float = 0.0,
    starboard_loss: float = 0.0,
) -> tuple[float, float]:
    """Thrust of port and starboard [N] for a surge force [N] and a moment [N m].

    Yaw has priority: the moment is met as far as the thrusters reach, then surge as far as it is
    still free.

    Parameters
    ----------
    speed, rate : ahead through the water [m/s], of turn [rad/s]
    port_loss, starboard_loss : share of its thrust that each has lost
    """
    port, starboard = speed - p.lever_m * rate, speed + p.lever_m * rate
    left, right = 1.0 - port_loss, 1.0 - starboard_loss
    low_port = left * thrust_under_way(p.thrust_low, port, p.disc_kgpm)
    high_port = left * thrust_under_way(p.thrust_high, port, p.disc_kgpm)
    low_starboard = right * thrust_under_way(p.thrust_low, starboard, p.disc_kgpm)
    high_starboard = right * thrust_under_way(p.thrust_high, starboard, p.disc_kgpm)
    difference = clipped(moment / p.lever_m, low_starboard - high_port, high_starboard - low_port)
    low = 2.0 * max(low_port + 0.5 * difference, low_starboard - 0.5 * difference)
    high = 2.0 * min(high_port + 0.5 * difference, high_starboard - 0.5 * difference)
    sum_ = clipped(surge, low, high)
    return 0.5 * (sum_ - difference), 0.5 * (sum_ + difference)


@kernel
def command_for(p: ModelRecord, thrust: float, speed: float) -> float:
    """Command whose steady thrust is nearest to `thrust` [N], in the thruster's unit and range.

    Inside the dead zone the nearer of nothing and its edge.

    Parameters
    ----------
    speed : of the propeller ahead through the water [m/s]
    """
    thrust = moored_thrust(thrust, speed, p.disc_kgpm)
    if p.exponent == 1.0:
        command = thrust / (p.k_ahead if thrust > 0.0 else p.k_astern)
    elif thrust > 0.0:
        command = math.sqrt(thrust / p.k_ahead)
    else:
        command = -math.sqrt(-thrust / p.k_astern)
    if abs(command) < p.dead_zone:
        command = 0.0 if abs(command) < 0.5 * p.dead_zone else math.copysign(p.dead_zone, command)
    return clipped(command, p.command_low, p.command_high)


@kernel
def thrust_of(p: ModelRecord, command: float, speed: float) -> float:
    """Steady thrust of one side [N] under a command, at a speed as in `command_for`."""
    if abs(command) < p.dead_zone:
        return 0.0
    k = p.k_ahead if command > 0.0 else p.k_astern
    moored = k * command * (1.0 if p.exponent == 1.0 else abs(command))
    return float(thrust_under_way(moored, speed, p.disc_kgpm))


@kernel
def lagged(p: ModelRecord, state: float, command: float, step_s: float) -> float:
    """State of a thruster's first-order lag after a step of a constant command."""
    return command + (state - command) * math.exp(-step_s / p.lag_s)


@kernel
def led_command(p: ModelRecord, state: float, command: float, step_s: float) -> float:
    """The command that brings the lag's state towards `command` as a lag of `LEAD` would."""
    share = math.exp(-step_s / (LEAD * p.lag_s)) - 1.0
    lead = share / (math.exp(-step_s / p.lag_s) - 1.0)
    return clipped(state + lead * (command - state), p.command_low, p.command_high)
