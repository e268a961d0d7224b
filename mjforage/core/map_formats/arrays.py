"""Arrays that `numpy.save` wrote (`.npy`), never unpickled."""

import zipfile
from pathlib import Path

import numpy as np

from mjforage.core.errors import UserError
from mjforage.core.map_formats.levels import Levels, check_size, levels_of

MAGIC = b"\x93NUMPY"


def read_array(path: Path, name: str) -> Levels:
    """Levels of an array (row, column) of booleans, of 0 and 1, or of 0 and 255.

    Its header is checked against the file's length before any cell is read.

    Parameters
    ----------
    path : the file
    name : what errors call the map

    Raises
    ------
    UserError
        If it is no such array.
    """
    try:
        array = np.load(path, mmap_mode="r", allow_pickle=False)
    except (OSError, ValueError, TypeError, EOFError, ArithmeticError, zipfile.BadZipFile) as error:
        raise UserError(f"map {name}: is damaged, or no array of numbers of numpy.save") from error
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "buif" or array.ndim != 2:
        raise UserError(f"map {name}: is no array (row, column) of numbers; give one of 0 and 1")
    check_size(*array.shape, name)
    return levels_of(np.asarray(array, np.float64), name)
