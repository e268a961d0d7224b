"""Wind over height: from the height of a record to that of a hull or an item."""

import numpy as np
from numpy.typing import NDArray

RECORD_HEIGHT_M = 10.0  # at which meteorology measures wind (WMO-No. 8, volume I, chapter 5)
POWER_EXPONENT = 0.11  # over open sea (Hsu, Meindl and Gilhousen 1994)


def height_factor(
    height_m: NDArray[np.float64],
    reference_m: float = RECORD_HEIGHT_M,
    exponent: float = POWER_EXPONENT,
) -> NDArray[np.float64]:
    """Wind at a height over wind at the reference height: (z / ref)^p.

    The power law (Stull, An Introduction to Boundary Layer Meteorology, section 9.7). Scenarios
    give their wind at the height of the hulls; a record brings its own height.

    Parameters
    ----------
    height_m : (point,) above the water

    Returns
    -------
    (point,) factor

    Raises
    ------
    ValueError
        If a height is negative or not finite.
    """
    heights = np.asarray(height_m, np.float64)
    if not (heights >= 0.0).all() or np.isinf(heights).any():
        raise ValueError(f"height_m = {heights}: heights above water are finite and at least 0")
    return np.asarray((heights / reference_m) ** exponent)
