"""Small maps drawn as strings."""

import numpy as np
from numpy.typing import NDArray


def grid(*rows: str) -> NDArray[np.bool_]:
    """A map from strings: `.` water, `#` land."""
    return np.array([[cell == "." for cell in row] for row in rows])
