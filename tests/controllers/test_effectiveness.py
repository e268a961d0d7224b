"""Lost thrust is noticed from what the hull does, on the right side and in time."""

import math
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.controllers import Pilot
from mjforage.controllers.allocation import allocate, command_for
from mjforage.controllers.effectiveness import (
    LAME_LOSS,
    REST_S,
    count_loss,
    is_lame,
    notice_losses,
    weaken,
)
from mjforage.controllers.loops import munk_moment, surge_drag, yaw_drag
from mjforage.controllers.vessel_model import packed
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Simulation
from mjforage.physics.vessel_models import vessel_model
from mjforage.physics.vessels import load_vessel
from tests.controllers.plant import FORAGER as P
from tests.controllers.plant import blank

FAULT_S = 5.0
FloatArray = NDArray[np.float64]


class Sailed(NamedTuple):
    """What vessels noticed."""

    losses: FloatArray  # (tick, vessel, 2) port, starboard

    def noticed_s(self) -> FloatArray:
        """(vessel, 2) time from the fault until it is noticed [s], infinite for never."""
        seen = self.losses > 0.0
        return np.where(seen.any(axis=0), 0.1 * seen.argmax(axis=0) - FAULT_S, np.inf)


def sailed(
    name: str,
    loss: tuple[float, float],
    yaw: float,
    seconds: float,
    wind: tuple[FloatArray, FloatArray] | None = None,
    to_and_fro: bool = False,
) -> Sailed:
    """Vessels of one fleet each, in calm water or a wind (x, y) each, go to a point 40 m away."""
    vessel, n = load_vessel(name), 1 if wind is None else len(wind[0])
    simulation = Simulation(build_scene([vessel]), n)
    pilot = Pilot([vessel_model(vessel)], None, n, notices=True)
    pose, to = np.zeros((n, 1, 3)), np.tile(np.array([40.0, 0.0]), (n, 1, 1))
    pose[..., 2] = yaw
    simulation.place_vessels(pose)
    if wind is not None:
        simulation.vessel_wind[:, 0, 0], simulation.vessel_wind[:, 0, 1] = wind
    active, losses = np.ones(n, np.bool_), []
    for tick in range(round(seconds / 0.1)):
        if to_and_fro and tick % 400 == 399:
            to = 40.0 - to
        if tick % 100 == 0:
            pilot.order(active, pose[..., :2].copy(), to, np.zeros((n, 1), np.bool_))
        if tick == round(FAULT_S / 0.1):
            simulation.thrust_loss[:] = loss
        pose = simulation.vessel_pose
        simulation.commands[:] = pilot.command(active, pose, simulation.vessel_velocity)
        simulation.step()
        state = pilot._fleets.state[:, 0]
        losses.append(np.stack((state["port_loss"], state["starboard_loss"]), axis=-1))
    return Sailed(np.array(losses))


@pytest.mark.parametrize("name", ["forager", "scout"])
@pytest.mark.parametrize("yaw", [0.0, 2.0], ids=["straight", "turn"])
@pytest.mark.parametrize("side", [0, 1], ids=["port", "starboard"])
def test_a_dead_thruster_is_noticed_within_half_a_minute(name: str, yaw: float, side: int) -> None:
    loss = (1.0, 0.0) if side == 0 else (0.0, 1.0)
    found = sailed(name, loss, yaw, 60.0)
    (noticed,) = found.noticed_s()
    assert 0.5 < noticed[side] < 30.0
    assert noticed[1 - side] == np.inf
    assert found.losses[-1, 0, side] > LAME_LOSS


def test_a_healthy_vessel_notices_nothing_in_calm_water_and_in_wind() -> None:
    angle = np.arange(8) * np.pi / 4
    for name in ("forager", "scout"):
        assert sailed(name, (0.0, 0.0), 0.0, 60.0).losses.max() == 0.0
        wind = 8.0 * np.cos(angle), 8.0 * np.sin(angle)
        assert sailed(name, (0.0, 0.0), 1.0, 60.0, wind).losses.max() == 0.0


def test_what_a_weak_thruster_has_lost_is_found() -> None:
    """A forager with half of the thrust at port goes to and fro for 5 minutes, in calm water."""
    found = sailed("forager", (0.5, 0.0), 0.0, 300.0, to_and_fro=True)
    assert found.noticed_s()[0, 0] < 120.0 and found.noticed_s()[0, 1] == np.inf
    assert found.losses[-1, 0, 0] == pytest.approx(0.5, abs=0.08)


@pytest.mark.parametrize("gain", [0.0, 0.05], ids=["steady", "faster"])
def test_a_healthy_turn_in_a_current_leaves_nothing_unexplained(gain: float) -> None:
    """Thrusts are what the equations of motion ask for; the vessel gains so many m/s2."""
    s, lever = blank(), P.lever_m
    s.yaw, s.drift_x, s.drift_y, s.sway, s.rate = 0.6, 0.3, -0.2, -0.05, 0.15
    for tick in range(100):
        surge = 0.6 + gain * 0.1 * tick
        s.vx = s.drift_x + surge * math.cos(s.yaw) - s.sway * math.sin(s.yaw)
        s.vy = s.drift_y + surge * math.sin(s.yaw) + s.sway * math.cos(s.yaw)
        both = P.mass_surge_kg * gain + surge_drag(P, surge) - P.mass_sway_kg * s.sway * s.rate
        more = (munk_moment(s, P) - yaw_drag(P, s.rate)) / lever  # port less starboard
        s.port = command_for(P, 0.5 * (both + more), surge - lever * s.rate)
        s.starboard = command_for(P, 0.5 * (both - more), surge + lever * s.rate)
        notice_losses(s, P, 0.1)
    assert max(abs(s.port_off), abs(s.starboard_off), abs(s.bias)) < 1e-5


def test_in_contact_the_estimates_stand_still_and_for_a_while_after() -> None:
    """A vessel at rest against a quay, port full ahead: it looks as if that thruster were dead."""
    s = blank()
    s.port = P.command_high
    for _ in range(600):
        s.in_contact = 1.0
        notice_losses(s, P, 0.1)
    assert s.port_off == s.starboard_off == 0.0
    s.in_contact = 0.0
    for _ in range(round(REST_S / 0.1) - 2):
        notice_losses(s, P, 0.1)
    assert s.port_off == 0.0
    for _ in range(600):
        notice_losses(s, P, 0.1)
    assert s.port_loss > 0.5 and s.starboard_loss == 0.0


@pytest.mark.parametrize(
    ("before", "port", "starboard", "variance", "loss"),
    [
        (0.0, 0.19, 0.0, 0.0, 0.0),  # below the threshold
        (0.0, 0.3, 0.0, 0.0, 0.3),
        (0.0, 0.3, 0.2, 0.0, 0.0),  # both alike: a load
        (0.0, 0.3, 0.0, 1e-3, 0.0),  # not sure
        (0.0, 0.45, 0.0, 1e-3, 0.45),
        (0.3, 0.15, 0.0, 0.02, 0.15),  # hysteresis
        (0.3, 0.09, 0.0, 0.0, 0.0),
        (0.3, 1.2, 0.0, 0.0, 0.9),  # commands are divided by what is left
    ],
)
def test_when_a_loss_counts(
    before: float, port: float, starboard: float, variance: float, loss: float
) -> None:
    for side, other in (("port", "starboard"), ("starboard", "port")):
        s = blank()
        setattr(s, f"{side}_loss", before)
        setattr(s, f"{side}_off", port)
        setattr(s, f"{other}_off", starboard)
        s.port_var = s.starboard_var = variance
        count_loss(s)
        assert getattr(s, f"{side}_loss") == pytest.approx(loss)
        assert getattr(s, f"{other}_loss") == 0.0


def test_allocation_within_what_is_left() -> None:
    high, low = P.thrust_high, P.thrust_low
    assert allocate(P, 1000.0, 0.0, 0.0, 0.0, 0.0, 0.5) == pytest.approx((0.5 * high, 0.5 * high))
    assert allocate(P, 0.0, 1000.0, 0.0, 0.0, 0.0, 0.5) == pytest.approx((low, 0.5 * high))
    assert allocate(P, 40.0, 1.0, 0.0, 0.0, 1.0, 0.0) == pytest.approx((0.0, 1.0 / P.lever_m))


def test_safe_speeds_follow_the_weaker_brake() -> None:
    s, p = blank(), packed(vessel_model(load_vessel("forager")))
    s.port_loss = 0.3
    weaken(s, p)
    assert p.brake_mps2 == pytest.approx(0.7 * P.brake_mps2)
    assert p.cruise_ahead_mps == pytest.approx(math.sqrt(0.7) * P.cruise_ahead_mps)
    assert p.cruise_astern_mps == pytest.approx(math.sqrt(0.7) * P.cruise_astern_mps)
    assert p.yaw_rate_radps == pytest.approx(math.sqrt(0.85) * P.yaw_rate_radps)
    assert p.yaw_acceleration_radps2 == pytest.approx(0.85 * P.yaw_acceleration_radps2)


def test_a_vessel_is_lame_by_either_side() -> None:
    s = blank()
    for s.port_loss, s.starboard_loss, lame in (
        (0.7, 0.0, True),
        (0.0, 0.7, True),
        (0.5, 0.5, False),
    ):
        assert is_lame(s) == lame
