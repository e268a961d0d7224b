"""Predicted motion: a coarse model of a vessel under its own controllers, for planning."""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.angles import clipped
from mjforage.controllers.guidance import stopping_speed
from mjforage.controllers.legs import REACTION_S, VIA_SPEED, best_way
from mjforage.controllers.loops import turning_limit
from mjforage.controllers.state import VesselState
from mjforage.controllers.vessel_model import FloatArray, ModelRecord

SAMPLES = 40  # poses of a prediction
SAMPLE_S = 0.25  # between two of them
AT_M = 0.4  # from a point: there
ARRIVAL_M = 0.9  # from the target: counts as arrived
SETTLE_S = 0.6  # of a heading, at the end of a turn
TURNED = 0.98  # cosine of the heading error below which a vessel does not yet go astern
CRUISE_SHARE = 0.93  # of the cruise speed, made good
GAIN_SHARE = 0.7  # of the acceleration, likewise
NEVER_S = 100.0  # time of an arrival that is not foreseen


@kernel
def predict(
    s: VesselState,
    p: ModelRecord,
    via_x: float,
    via_y: float,
    wait_s: float,
    end_x: float,
    end_y: float,
    out: FloatArray,
) -> float:
    """Fill in the poses to come and return the time of arrival [s].

    Parameters
    ----------
    via_x, via_y : point to pass first [m]; NaN for none
    wait_s : time before the vessel moves on, at the via point or, without one, where it is
    end_x, end_y : end position [m]
    out : (SAMPLES, 4) x, y [m], cosine and sine of the heading, every `SAMPLE_S` from now
    """
    x, y, rate = s.x, s.y, s.rate
    c, t = math.cos(s.yaw), math.sin(s.yaw)
    speed = c * s.vx + t * s.vy
    via = not math.isnan(via_x)
    goal_x, goal_y = (via_x, via_y) if via else (end_x, end_y)
    arrival, way, holding = NEVER_S, 0.0, False
    gain, brake = GAIN_SHARE * p.acceleration_mps2 * SAMPLE_S, p.brake_mps2 * SAMPLE_S
    spin, reaction = 0.5 * p.yaw_acceleration_radps2 * SAMPLE_S, p.lag_s + REACTION_S
    for k in range(SAMPLES):
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = x, y, c, t
        if holding:
            speed -= clipped(speed, -brake, brake)
            x, y = x + c * speed * SAMPLE_S, y + t * speed * SAMPLE_S
            continue
        dx, dy = goal_x - x, goal_y - y
        far = math.sqrt(dx * dx + dy * dy)
        if far < ARRIVAL_M and not via and arrival == NEVER_S:
            arrival = k * SAMPLE_S
        if far < AT_M and not via:
            holding = True
            continue
        if far < AT_M and k * SAMPLE_S < wait_s:
            speed -= clipped(speed, -brake, brake)
            x, y = x + c * speed * SAMPLE_S, y + t * speed * SAMPLE_S
            continue
        if far < AT_M:
            via, way = False, 0.0
            goal_x, goal_y = end_x, end_y
            dx, dy = goal_x - x, goal_y - y
            far = max(math.sqrt(dx * dx + dy * dy), 1e-6)
        along, across = (c * dx + t * dy) / far, (c * dy - t * dx) / far
        if way == 0.0:
            drift_x, drift_y = s.drift_x / far, s.drift_y / far
            way = best_way(
                p,
                math.atan2(across, along),
                far,
                dx * drift_x + dy * drift_y,
                dx * drift_y - dy * drift_x,
            )
        along, across = way * along, way * across
        cruise = p.cruise_ahead_mps if way > 0.0 else p.cruise_astern_mps
        room = far + (0.5 * (VIA_SPEED * cruise) ** 2 / p.brake_mps2 if via else 0.0)
        wanted = min(CRUISE_SHARE * cruise, stopping_speed(room, p.brake_mps2, reaction))
        wanted = way * min(wanted, turning_limit(p, along))
        # Turning takes the thrust that drives astern.
        if (not via and k * SAMPLE_S < wait_s) or (way < 0.0 and along < TURNED):
            wanted = 0.0
        step = brake if abs(wanted) < abs(speed) or wanted * speed < 0.0 else gain
        speed += clipped(wanted - speed, -step, step)
        turn = clipped(math.atan2(across, along) / SETTLE_S, -p.yaw_rate_radps, p.yaw_rate_radps)
        rate += clipped(turn - rate, -spin, spin)
        angle = rate * SAMPLE_S
        half = angle * angle / 2.0
        cosine, sine = 1.0 - half + half * half / 6.0, angle * (1.0 - half / 3.0)
        c, t = c * cosine - t * sine, t * cosine + c * sine
        aside = c * s.drift_y - t * s.drift_x  # the speed loop takes care of the rest
        x += (c * speed - t * aside) * SAMPLE_S
        y += (t * speed + c * aside) * SAMPLE_S
    return arrival
