"""Radio propagation: path loss over distance, walls and water, and packet errors by noise.

Sources: log-distance and two-ray models, T. S. Rappaport, Wireless Communications (2nd ed., 2002),
chapter 4; error rate of QPSK, J. G. Proakis, Digital Communications (4th ed., 2001), chapter 5.
"""

import math

from mjforage.base.compiled import kernel
from mjforage.graph_planner.graph.geodesics import Int32Array

LIGHT_MPS = 299_792_458.0
LEAST_M = 1.0  # distance below which nothing gets stronger


@kernel
def log_distance_loss_db(d_m: float, exponent: float, l0_db: float) -> float:
    """Path loss L0 + 10 n log10 d, d at least 1 m [dB]."""
    return float(l0_db + 10.0 * exponent * math.log10(max(d_m, LEAST_M)))


@kernel
def two_ray_loss_db(d_m: float, low_m: float, high_m: float, frequency_hz: float) -> float:
    """Path loss of the direct ray and its echo from the water, reflected by -1 [dB].

    The sum of both with their phases; far off it nears 40 log d - 20 log(h_t h_r).

    Parameters
    ----------
    d_m : horizontal distance, at least 1 m counts
    low_m, high_m : heights of the antennas
    frequency_hz : of the carrier
    """
    d, k = max(d_m, LEAST_M), 2.0 * math.pi * frequency_hz / LIGHT_MPS
    direct = math.sqrt(d * d + (high_m - low_m) ** 2)
    echo = math.sqrt(d * d + (high_m + low_m) ** 2)
    phase = k * (echo - direct)
    re = 1.0 / direct - math.cos(phase) / echo
    im = math.sin(phase) / echo
    amplitude = math.sqrt(re * re + im * im) / (2.0 * k)
    return float(-20.0 * math.log10(max(amplitude, 1e-30)))


@kernel
def packet_error(snr_db: float, size: int) -> float:
    """Chance that noise garbles a packet of so many bytes, modulated by QPSK.

    BER = Q(sqrt(2 Eb/N0)), PER = 1 - (1 - BER)^(8 bytes); the noise is that of a bit.
    """
    ber = 0.5 * math.erfc(math.sqrt(10.0 ** (0.1 * snr_db)))
    return float(-math.expm1(8.0 * size * math.log1p(-ber)))


@kernel
def walls_between(node_of_cell: Int32Array, row: int, col: int, to_row: int, to_col: int) -> int:
    """Land cells on the rounded straight line between two cells, the same both ways.

    One cell per unit of the longer axis; halves round away from the end with the smaller row, or
    column.
    """
    if to_row < row or (to_row == row and to_col < col):
        row, col, to_row, to_col = to_row, to_col, row, col
    down, right = to_row - row, to_col - col
    points, walls = max(abs(down), abs(right)), 0
    for k in range(1, points):
        r = row + (2 * k * down + points) // (2 * points)
        aside = (2 * k * abs(right) + points) // (2 * points)
        c = col + (aside if right > 0 else -aside)
        walls += node_of_cell[r, c] < 0
    return walls


def gilbert_elliott(loss: float, burst: float) -> tuple[float, float]:
    """Chances per decision that a good link turns bad, and a bad one good.

    For a mean share of bad decisions and a mean length of such a time: r = 1 / burst and
    p = r loss / (1 - loss) (E. N. Gilbert, Bell Syst. Tech. J. 39, 1960). Independent decisions,
    burst 1, are p = loss, r = 1 - loss.
    """
    if burst == 1.0:
        return loss, 1.0 - loss
    return loss / (burst * (1.0 - loss)), 1.0 / burst
