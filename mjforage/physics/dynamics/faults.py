"""Times at which thrusters fail, and their losses: from a scenario's table `[faults]`."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Launch
from mjforage.base.randomness import Stream, UInt64Array, stream_key, uniform
from mjforage.scenario.faults import SIDES, Faults
from mjforage.scenario.roles import Fleet

FloatArray = NDArray[np.float64]
HOUR_S = 3600.0


@kernel
def _lose(from_s: FloatArray, loss: float, now_s: FloatArray, lost: FloatArray) -> None:
    """Write the share of the thrust lost at a time (episode,) [s], (episode, vessel, 2)."""
    for e in range(from_s.shape[0]):
        for v in range(from_s.shape[1]):
            for side in range(2):
                lost[e, v, side] = loss if now_s[e] >= from_s[e, v, side] else 0.0


LOSE = Launch(_lose)


@dataclass(frozen=True)
class Failures:
    """Faults of a batch.

    Attributes
    ----------
    from_s : (episode, vessel, 2) when port and starboard fail [s], infinite for never
    loss : share of the thrust that a fault takes
    """

    from_s: FloatArray
    loss: float

    def losses(self, now_s: NDArray[np.floating[Any]]) -> FloatArray:
        """(episode, vessel, 2) share of the thrust lost at a time (episode,) [s]."""
        lost = np.empty(self.from_s.shape)
        _lose(self.from_s, self.loss, np.asarray(now_s, np.float64), lost)
        return lost


@kernel
def drawn_s(rate_per_h: float, vessels: int, keys: UInt64Array) -> FloatArray:
    """(episode, vessel, 2) times at which thrusters fail [s]: exponential, at a rate > 0."""
    out = np.empty((keys.size, vessels, 2))
    for e in range(keys.size):
        key = stream_key(keys[e], Stream.FAULTS)
        for v in range(vessels):
            for side in range(2):
                share = uniform(key, 2 * v + side, 0)
                out[e, v, side] = -math.log1p(-share) * (HOUR_S / rate_per_h)
    return out


def failures(faults: Faults, fleet: Fleet, keys: UInt64Array) -> Failures | None:
    """Faults of the episodes with the given keys (episode,); None if no thruster can fail."""
    if not faults.any:
        return None
    from_s = np.full((keys.size, len(fleet), 2), np.inf)
    if faults.rate_per_h > 0.0:
        from_s = drawn_s(faults.rate_per_h, len(fleet), keys)
    if faults.team:
        vessel = fleet.names.index(f"{faults.team}_{faults.vessel}")
        from_s[:, vessel, SIDES[faults.side]] = faults.from_s
    return Failures(from_s, 1.0 - faults.left)
