"""Damping is the slope of all loads of a hull, its thrusters included."""

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mjforage.physics.callback.vessel_motion import Surroundings, damping, loads
from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.thruster import thrust
from mjforage.physics.vessels import load_vessel

P = {name: pack(load_vessel(name)) for name in ("otter", "forager")}
STILL = Surroundings(0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0)
STEP = 1e-5


@pytest.mark.parametrize("name", P)
@given(
    st.floats(-2.0, 2.5),
    st.floats(-100.0, 100.0),
    st.sampled_from([(1.0, 1.0), (0.0, 1.0), (0.7, 0.0)]),
)
def test_damping_in_surge_is_the_slope_of_the_load(
    name: str, u: float, command: float, left: tuple[float, float]
) -> None:
    """Also with a thruster that is weak or dead."""
    assume(abs(u) > 1e-3)  # off the kink at rest
    moored = thrust(P[name], command)
    around = STILL._replace(port_left=left[0], starboard_left=left[1])
    less, more = (
        loads(P[name], 0.0, u + h, 0.0, 0.0, moored, moored, around)[0] for h in (STEP, -STEP)
    )
    surge, _, _ = damping(P[name], 0.0, u, 0.0, 0.0, (command, command), around)
    assert (more - less) / (2.0 * STEP) == pytest.approx(surge, rel=1e-4)


@given(st.floats(0.3, 2.5), st.floats(-0.5, 0.5), st.floats(20.0, 100.0))
def test_damping_in_yaw_has_that_of_the_thrusters(u: float, r: float, command: float) -> None:
    """More by lever^2 than without thrust, for as much less in surge."""
    surge, _, yaw = damping(P["otter"], 0.0, u, 0.0, r, (command, command), STILL)
    bare, _, turn = damping(P["otter"], 0.0, u, 0.0, r, (0.0, 0.0), STILL)
    assert surge > bare
    assert yaw - turn == pytest.approx(0.395**2 * (surge - bare))
