"""Reference models: heading and speed that a vessel can follow towards the commanded ones."""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.angles import clipped, wrapped


@kernel
def heading_reference(
    heading: float,
    rate: float,
    wanted: float,
    most_rate: float,
    most_acceleration: float,
    step_s: float,
) -> tuple[float, float]:
    """Heading reference and its rate after a step, by the short way and without overshoot.

    The rate goes for the largest from which the rest of the turn still allows to stop,
    min(most_rate, sqrt(2 a |e|)), changing by at most `most_acceleration`; half of that is used
    to stop, so that the steps of time leave no overshoot.

    Returns
    -------
    heading [rad], rate [rad/s]
    """
    error = wrapped(wanted - heading)
    reach = min(math.sqrt(most_acceleration * abs(error)), abs(error) / (2.0 * step_s))
    target = math.copysign(min(most_rate, reach), error)
    change = most_acceleration * step_s
    following = rate + clipped(target - rate, -change, change)
    return heading + 0.5 * (rate + following) * step_s, following


@kernel
def speed_reference(
    speed: float, wanted: float, acceleration: float, brake: float, step_s: float
) -> float:
    """Speed reference after a step; away from rest with `acceleration`, towards it with `brake`."""
    if speed * wanted < 0.0:
        return math.copysign(max(abs(speed) - brake * step_s, 0.0), speed)
    if abs(wanted) < abs(speed):
        return math.copysign(max(abs(speed) - brake * step_s, abs(wanted)), speed)
    return math.copysign(min(abs(speed) + acceleration * step_s, abs(wanted)), wanted)
