"""Reach of a link over open water, for planners that use it."""

import numpy as np
from numpy.typing import NDArray

from mjforage.mission.link.propagation import log_distance_loss_db, packet_error, two_ray_loss_db
from mjforage.scenario.link import SCAN_BYTES, Link

EVEN = 0.5  # chance at which a scan counts as garbled
_FARTHEST_M, _SOUNDINGS = 1e6, 2000


def reach_m(link: Link, antenna_m: NDArray[np.float64]) -> float:
    """Farthest distance at which the least scan gets through half the time [m]; inf if ideal.

    By the mean power: shadowing is left out.

    `antenna_m`: (agent,) heights, of which the lowest two count.
    """
    if link.model in ("ideal", "none"):
        return np.inf if link.model == "ideal" else 0.0
    if link.model == "disk":
        return link.range_m
    low, high = np.sort(antenna_m)[[0, -1]] if antenna_m.size < 2 else np.sort(antenna_m)[:2]
    margin, farthest = link.tx_dbm - link.floor_dbm, 0.0
    for sounding in range(_SOUNDINGS):
        d = _FARTHEST_M ** (sounding / (_SOUNDINGS - 1))
        if link.model == "log-distance":
            loss = log_distance_loss_db(d, link.exponent, link.l0_db)
        else:
            loss = two_ray_loss_db(d, float(low), float(high), link.frequency_hz)
        farthest = d if packet_error(margin - loss, SCAN_BYTES) < EVEN else farthest
    return farthest
