"""Stream functions on a map of elements: unknowns, and the minimum of drag less work."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mjforage.forcing.elimination import least_of_elements
from mjforage.forcing.stream_element import FloatArray, element_matrix


def shore_unknowns(water: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(y vertex, x vertex, 4) number of each unknown of the streams, -1 for those that are zero.

    At land slopes are zero and psi is one number per piece, which is zero for the largest; without
    land it is zero at one vertex.
    """
    pieces, count = ndimage.label(~water, np.ones((3, 3)))  # no water passes between corners
    framed = np.pad(pieces, 1)
    piece = np.max([framed[1:, 1:], framed[:-1, 1:], framed[1:, :-1], framed[:-1, :-1]], axis=0)
    unknown = np.full((*piece.shape, 4), -1)
    afloat = piece == 0
    unknown[afloat] = np.arange(4 * np.count_nonzero(afloat)).reshape(-1, 4)
    number = 4 * int(np.count_nonzero(afloat))
    largest = int(np.argmax(np.bincount(pieces.ravel())[1:])) + 1 if count else 0
    for n in range(1, count + 1):
        if n != largest:
            unknown[piece == n, 0] = number
            number += 1
    if not count:
        unknown[0, 0, 0] = -1
        unknown[unknown > 0] -= 1
    return unknown


def still_unknowns(water: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(y vertex, x vertex, 4) number of each unknown of the circulation, -1 at quays and rim."""
    framed = np.pad(water, 1)
    inner = framed[1:, 1:] & framed[:-1, 1:] & framed[1:, :-1] & framed[:-1, :-1]
    unknown = np.full((*inner.shape, 4), -1)
    unknown[inner] = np.arange(4 * np.count_nonzero(inner)).reshape(-1, 4)
    return unknown


def stream_functions(
    water: NDArray[np.bool_], unknown: NDArray[np.int64], layer: float, forces: FloatArray
) -> FloatArray:
    """Solve on a grid of elements of side 1.

    Returns: (y vertex, x vertex, 4, force) psi, dpsi/dx, dpsi/dy, d2psi/dxdy.

    Parameters
    ----------
    water : (y, x) bool elements
    unknown : (y vertex, x vertex, 4) number of each unknown, -1 for zero
    layer : L in sides
    forces : (16, force) work of each on the unknowns of an element
    """
    count = int(unknown.max(initial=-1)) + 1
    y, x = np.nonzero(water)
    end, slope = np.divmod(np.arange(4), 2)  # of the 4 unknowns along one axis
    places = unknown[
        y[:, None, None] + end[:, None],
        x[:, None, None] + end,
        2 * slope[:, None] + slope,
    ].reshape(-1, 16)
    solved = np.zeros((count + 1, forces.shape[1]))
    if count:
        corners = np.stack((y, x), axis=1)
        solved[:count] = least_of_elements(places, corners, element_matrix(layer), forces)
    return solved[unknown]  # -1 is the last, which is zero
