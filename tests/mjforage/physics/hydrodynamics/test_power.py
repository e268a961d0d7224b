import dataclasses
import math

import pytest

from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.power import drawn_power, least_power
from mjforage.physics.vessels import IDEAL_POWER, load_vessel

DISC = math.pi / 4 * 0.2**2  # [m2]
RHO_A = 1025.0 * DISC  # [kg/m]
OTTER = load_vessel("otter")


def test_the_least_power_is_momentum_theory() -> None:
    """Bollard pull: T^1.5 / sqrt(2 rho A); fast: T u; astern mirrored."""
    assert least_power(DISC, 40.0, 0.0) == pytest.approx(40.0**1.5 / math.sqrt(2 * RHO_A))
    assert least_power(DISC, 1e-3, 3.0) == pytest.approx(3e-3, rel=1e-4)
    assert least_power(DISC, -40.0, -1.0) == least_power(DISC, 40.0, 1.0)
    assert least_power(DISC, 40.0, -1.0) == least_power(DISC, 40.0, 0.0)
    assert least_power(DISC, 0.0, 2.0) == 0.0
    slip, thrust = least_power(DISC, 40.0, 1.0) / 40.0 - 1.0, 40.0
    assert thrust == pytest.approx(2 * RHO_A * (1.0 + slip) * slip)  # T = 2 rho A (u + a) a


def test_a_vessel_without_the_table_draws_the_least() -> None:
    p = pack(dataclasses.replace(OTTER, power=IDEAL_POWER))
    assert drawn_power(p, 60.0, 0.0, 1.0) == least_power(DISC, 0.01108 * 3600.0, 1.0)
