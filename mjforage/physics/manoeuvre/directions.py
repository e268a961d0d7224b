"""`SPEED@DIRECTION` of a current or a wind, as the command line takes them."""

import math

from mjforage.base.errors import UserError
from mjforage.scenario.bearings import direction

FASTEST_MPS = 100.0  # of wind or current that is accepted: faster than any hurricane


def parse_flow(text: str, thing: str) -> tuple[float, float]:
    """Velocity (east, north) [m/s] of `0.3@90`: 0.3 m/s towards 90 degrees, which is north.

    Parameters
    ----------
    text : speed [m/s], then `@`, then the direction it flows to, in degrees counter-clockwise from
        east
    thing : name in error messages, for example `--current`

    Raises
    ------
    UserError
        If it is not two finite numbers, or the speed is negative or above 100 m/s.
    """
    speed_text, separator, direction_text = text.partition("@")
    try:
        speed, degrees = float(speed_text), float(direction_text)
    except ValueError:
        speed = math.nan
    if not separator or not math.isfinite(speed) or not math.isfinite(degrees):
        raise UserError(
            f"{thing} {text}: expected SPEED@DIRECTION, for example 0.3@90: "
            "0.3 m/s towards 90 degrees, which is north"
        )
    if not 0.0 <= speed <= FASTEST_MPS:
        raise UserError(f"{thing} {text}: speed is out of range; give 0 to {FASTEST_MPS:g} m/s")
    # Quarter turns are exact, so that 0.3@90 has no part to the east.
    quarters = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}
    angle = direction(degrees)
    east, north = quarters.get(degrees % 360.0, (math.cos(angle), math.sin(angle)))
    return speed * east, speed * north
