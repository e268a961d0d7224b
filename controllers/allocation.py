"""Thrust allocation to two fixed thrusters, yaw before surge, and the inverse of their curve."""

import math

from controllers._compiled import kernel
from controllers.angles import clipped
from controllers.helm import (
    DEAD,
    EXPONENT,
    HIGH,
    K_AHEAD,
    K_ASTERN,
    LAG,
    LEVER,
    LOW,
    THRUST_HIGH,
    THRUST_LOW,
    FloatArray,
)

LEAD = 0.5  # lag that is left of the thrusters' own


@kernel
def allocate(p: FloatArray, surge: float, moment: float) -> tuple[float, float]:
    """Thrust of port and starboard [N] for a surge force [N] and a moment [N m].

    Yaw has priority: the moment is met as far as the thrusters reach, then surge as far as it is
    still free.

    Parameters
    ----------
    p : (SIZE,) of `packed`
    """
    low, high = p[THRUST_LOW], p[THRUST_HIGH]
    difference = clipped(moment / p[LEVER], low - high, high - low)
    sum_ = clipped(surge, 2.0 * low + abs(difference), 2.0 * high - abs(difference))
    return 0.5 * (sum_ - difference), 0.5 * (sum_ + difference)


@kernel
def command_for(p: FloatArray, thrust: float) -> float:
    """Command whose steady thrust is nearest to `thrust` [N], in the thruster's unit and range.

    Inside the dead zone the nearer of nothing and its edge.
    """
    if p[EXPONENT] == 1.0:
        command = thrust / (p[K_AHEAD] if thrust > 0.0 else p[K_ASTERN])
    elif thrust > 0.0:
        command = math.sqrt(thrust / p[K_AHEAD])
    else:
        command = -math.sqrt(-thrust / p[K_ASTERN])
    if abs(command) < p[DEAD]:
        command = 0.0 if abs(command) < 0.5 * p[DEAD] else math.copysign(p[DEAD], command)
    return clipped(command, p[LOW], p[HIGH])


@kernel
def thrust_of(p: FloatArray, command: float) -> float:
    """Steady thrust of one side [N] under a command."""
    if abs(command) < p[DEAD]:
        return 0.0
    k = p[K_AHEAD] if command > 0.0 else p[K_ASTERN]
    return float(k * command * (1.0 if p[EXPONENT] == 1.0 else abs(command)))


@kernel
def lagged(p: FloatArray, state: float, command: float, step_s: float) -> float:
    """State of a thruster's first-order lag after a step of a constant command."""
    return command + (state - command) * math.exp(-step_s / p[LAG])


@kernel
def led_command(p: FloatArray, state: float, command: float, step_s: float) -> float:
    """The command that brings the lag's state towards `command` as a lag of `LEAD` would."""
    share = math.exp(-step_s / (LEAD * p[LAG])) - 1.0
    lead = share / (math.exp(-step_s / p[LAG]) - 1.0)
    return clipped(state + lead * (command - state), p[LOW], p[HIGH])
