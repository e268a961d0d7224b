"""The Ornstein-Uhlenbeck process as a fixed function of time, with access to any time at once.

A path is not stepped through: it is built around the wanted time from coarse to fine. Time is
counted in time constants. Root times lie 40 apart, where the correlation exp(-40) is below the
rounding of 1, so their values are independent. Given the process at both ends of an interval of
length h, its law at the middle is (Doob's bridge; e.g. Karatzas and Shreve, section 5.6.B)

    mean = (a + b) / (2 cosh(h/2)),    variance = tanh(h/2),

and at a distance s from the left end

    mean = (a sinh(h - s) + b sinh(s)) / sinh(h),    variance = 2 sinh(s) sinh(h - s) / sinh(h).

Halving the root interval 15 times, with a hashed normal per interval, leads to one of 1/819 of a
time constant, where the last formula with one hashed normal gives the value. The result is
continuous; its law is exact at any one time, and jointly at any times of which no two lie in the
same smallest interval.
"""

import math

import numpy as np

from mjforage.base.compiled import kernel
from mjforage.base.randomness import uniform
from mjforage.base.wholes import floor

ROOT = 40.0  # length of a root interval [time constant]
LEVELS = 15
SMALLEST = ROOT / 2**LEVELS  # length of an interval that is not halved any more [time constant]

_LENGTHS = ROOT / 2.0 ** np.arange(LEVELS)  # (level,) of the interval that is halved
# Of each end in the middle, and deviation of the middle, (level,).
_WEIGHTS = np.array([0.5 / math.cosh(h / 2) for h in _LENGTHS])
_DEVIATIONS = np.array([math.sqrt(math.tanh(h / 2)) for h in _LENGTHS])


@kernel
def normal_pair(key: np.uint64, index: int, step: int) -> tuple[float, float]:
    """Two independent standard normals of (stream key, index, step): both halves of Box-Muller."""
    radius = math.sqrt(-2.0 * math.log(1.0 - uniform(key, 2 * index, step)))
    angle = 2.0 * math.pi * uniform(key, 2 * index + 1, step)
    return radius * math.cos(angle), radius * math.sin(angle)


@kernel
def gauss_markov_pair(key: np.uint64, time: float) -> tuple[float, float]:
    """Two independent Ornstein-Uhlenbeck processes of variance 1 and covariance exp(-lag).

    `key`: stream key, one path each; `time`: finite [time constant], of either sign.
    """
    root = floor(time / ROOT)
    index, since = int(root), time - root * ROOT
    a0, a1 = normal_pair(key, index, 0)
    b0, b1 = normal_pair(key, index + 1, 0)
    half = ROOT
    for level in range(LEVELS):
        n0, n1 = normal_pair(key, index, level + 1)
        m0 = _WEIGHTS[level] * (a0 + b0) + _DEVIATIONS[level] * n0
        m1 = _WEIGHTS[level] * (a1 + b1) + _DEVIATIONS[level] * n1
        half, index = 0.5 * half, 2 * index
        if since < half:
            b0, b1 = m0, m1
        else:
            a0, a1, index, since = m0, m1, index + 1, since - half
    n0, n1 = normal_pair(key, index, LEVELS + 1)
    left, right = math.sinh(since), math.sinh(max(SMALLEST - since, 0.0))
    whole = math.sinh(SMALLEST)
    spread = math.sqrt(2.0 * left * right / whole)
    return (a0 * right + b0 * left) / whole + spread * n0, (
        a1 * right + b1 * left
    ) / whole + spread * n1
