"""Ticks of the controllers, which all other times of a mission are a whole number of."""

from mjforage.base.errors import UserError

CONTROL_S = 0.1  # controllers run at 10 Hz
WEATHER_TICKS = 5  # wind and current are looked up every 0.5 s, a quarter of a gust's memory


def whole_times(whole: float, part: float, name: str, least: int = 1) -> int:
    """Whole number of times that a time [s] goes into another, at least so many.

    Raises `UserError` if not a whole number of times.
    """
    count = round(whole / part)
    if count < least or abs(count * part - whole) > 1e-9 * whole:
        raise UserError(
            f"scenario: {name} does not fit; {whole:g} s has to be a whole number of times "
            f"{part:g} s"
        )
    return count
