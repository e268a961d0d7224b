"""Arrays that `numpy.save` wrote (`.npy`), never unpickled."""

import math
from pathlib import Path

import numpy as np
from numpy.lib import format as npy

from mjforage.base.errors import UserError
from mjforage.scenario.map_formats.levels import Levels, check_size, levels_of

_HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
_DAMAGED = (OSError, ValueError, TypeError, EOFError, ArithmeticError, LookupError)


def read_array(path: Path, name: str) -> Levels:
    """Levels of an array (row, column) of booleans, of 0 and 1, or of 0 and 255; NaN is unknown.

    Its header is checked against the file's length before any cell is read.

    Parameters
    ----------
    path : the file
    name : name of the map in messages

    Raises
    ------
    UserError
        If it is no such array.
    """
    try:
        with path.open("rb") as file:
            shape, _, kind = _HEADERS[npy.read_magic(file)](file)
            if kind.kind not in "buif" or len(shape) != 2:
                raise UserError(f"map {name}: is no array (row, column) of numbers; give 0 and 1")
            check_size(*shape, name)
            if path.stat().st_size < math.prod(shape) * kind.itemsize:
                raise EOFError
            file.seek(0)
            array = np.load(file, allow_pickle=False)
    except UserError:
        raise
    except _DAMAGED as error:
        raise UserError(f"map {name}: is damaged, or no array of numpy.save") from error
    values = np.asarray(array, np.float64)
    return levels_of(values, name, np.isnan(values))
