"""Vessel models of the controllers, and a tuning for vessels that bring none."""

import dataclasses
import math
from typing import get_type_hints

from mjforage.controllers import Tuning, VesselModel
from mjforage.controllers.propulsion import thrust_under_way
from mjforage.physics.vessels import Control, CrossFlow, Propeller, Vessel

SOURCE = "from mass, drag, thrust and lag, as where no file says otherwise"
SHARE = 0.9  # of the thrust, with which cruise speeds are reckoned; the rest steers


def vessel_model(vessel: Vessel) -> VesselModel:
    """The controllers' view of a vessel; without a `[control]` table, `default_control` is used."""
    control = vessel.control or default_control(vessel)
    thruster = vessel.thruster
    low, high = thruster.command_range
    propeller = isinstance(thruster, Propeller)
    return VesselModel(
        length_m=vessel.length_m,
        beam_m=vessel.beam_m,
        mass_surge_kg=_surge_kg(vessel),
        mass_sway_kg=vessel.mass_kg + vessel.added_mass_sway_kg,
        inertia_yaw_kgm2=_yaw_kgm2(vessel),
        munk_kg=vessel.added_mass_sway_kg - vessel.added_mass_surge_kg,
        offset_kgm=vessel.mass_kg * vessel.cog_x_m,
        linear_surge=vessel.linear_surge,
        quadratic_surge=vessel.quadratic_surge,
        linear_sway=vessel.linear_sway,
        quadratic_sway=_quadratic_sway(vessel),
        linear_yaw=vessel.linear_yaw,
        quadratic_yaw=_quadratic_yaw(vessel),
        lever_m=vessel.lever_m,
        lag_s=vessel.lag_s,
        k_ahead=thruster.k_ahead if isinstance(thruster, Propeller) else 1.0,
        k_astern=thruster.k_astern if isinstance(thruster, Propeller) else 1.0,
        exponent=2.0 if propeller else 1.0,
        command_low=low,
        command_high=high,
        dead_zone=0.0 if isinstance(thruster, Propeller) else thruster.dead_zone_newton,
        disc_kgpm=_disc_kgpm(vessel),
        tuning=Tuning(**dataclasses.asdict(control)),
    )


def default_control(vessel: Vessel) -> Control:
    """A tuning from mass, drag and thrust, for a vessel without one.

    Speeds and rates are those at which drag takes `SHARE` of the thrust under way (when turning,
    of equal thrusts ahead and astern);
    accelerations are what the thrust gives at rest; loops are slower than thruster lag, control
    period and thrust allow; lengths go with the vessel's.
    """
    low, high = vessel.thruster.thrust_range
    surge, yaw = _surge_kg(vessel), _yaw_kgm2(vessel)
    moment = -2.0 * low * vessel.lever_m if -low < high else 2.0 * high * vessel.lever_m
    brake = -2.0 * low / surge
    acceleration = 0.8 * moment / yaw
    quick = 1.0 / (0.2 + 2.0 * vessel.lag_s)
    heading = min(quick, math.sqrt(1.5 * moment / yaw))
    speed = min(quick, 1.5)
    hold = min(0.5 * speed, math.sqrt(brake / vessel.length_m))
    return Control(
        cruise_ahead_mps=_top_speed(vessel, high, SHARE),
        cruise_astern_mps=_top_speed(vessel, -low, SHARE),
        acceleration_mps2=SHARE * 2.0 * high / surge,
        brake_mps2=0.7 * brake,
        yaw_rate_radps=_top_rate(vessel, SHARE),
        yaw_acceleration_radps2=acceleration,
        heading_bandwidth_radps=heading,
        heading_damping=1.0,
        heading_integral_s=10.0 / heading,
        speed_bandwidth_radps=speed,
        speed_integral_s=5.0 / speed,
        lookahead_m=1.5 * vessel.length_m,
        drift_gain_mps=1.0,
        hold_bandwidth_radps=hold,
        hold_integral_s=3.0 / hold,
        hold_radius_m=0.15 * vessel.length_m,
        clearance_m=0.15 * vessel.length_m,
        filter_s=3.0,
    )


def control_table(vessel: Vessel) -> str:
    """`default_control` as the table of a vessel's file, in full; the vessel moves alike."""
    facts = get_type_hints(Control, include_extras=True)
    lines = [
        f'{key} = {{ value = {value!r}, unit = "{facts[key].__metadata__[0].unit}", '
        f'source = "{SOURCE}" }}\n'
        for key, value in dataclasses.asdict(default_control(vessel)).items()
    ]
    return "".join(("[control]\n", *lines))


def full_speed_s(vessel: Vessel) -> float:
    """Time from rest to cruise speed with full thrust and without drag [s]."""
    cruise = vessel_model(vessel).tuning.cruise_ahead_mps
    return _surge_kg(vessel) * cruise / (2.0 * vessel.thruster.thrust_range[1])


def top_speed(vessel: Vessel) -> float:
    """Speed through the water with full thrust ahead or astern, the higher of the two [m/s]."""
    low, high = vessel.thruster.thrust_range
    return _top_speed(vessel, max(high, -low))


def damping_rates(vessel: Vessel) -> dict[str, float]:
    """Rates at which drag takes small motions [1/s]: ahead at cruise speed, aside at rest, and
    turning at the highest rate.
    """
    tuning = vessel_model(vessel).tuning
    surge = vessel.linear_surge + 2.0 * vessel.quadratic_surge * tuning.cruise_ahead_mps
    yaw = vessel.linear_yaw + 2.0 * _quadratic_yaw(vessel) * tuning.yaw_rate_radps
    return {
        "way ahead": surge / _surge_kg(vessel),
        "way aside": vessel.linear_sway / (vessel.mass_kg + vessel.added_mass_sway_kg),
        "turning": yaw / _yaw_kgm2(vessel),
    }


def decision_s(vessel: Vessel, distance_m: float) -> float:
    """Time from rest to turn by 90 degrees, go a distance straight on and stop [s]."""
    tuning = vessel_model(vessel).tuning
    speed = min(tuning.cruise_ahead_mps, _top_speed(vessel, vessel.thruster.thrust_range[1]))
    ramps = 0.5 / tuning.acceleration_mps2 + 0.5 / tuning.brake_mps2
    speed = min(speed, math.sqrt(distance_m / ramps))  # so short that it never cruises
    straight = distance_m / speed + ramps * speed
    return 0.5 * math.pi / tuning.yaw_rate_radps + straight


def _surge_kg(vessel: Vessel) -> float:
    return vessel.mass_kg + vessel.added_mass_surge_kg


def _yaw_kgm2(vessel: Vessel) -> float:
    return vessel.inertia_z_kgm2 + vessel.added_mass_yaw_kgm2


def _quadratic_sway(vessel: Vessel) -> float:
    """Quadratic part and cross-flow of a vessel moving sideways."""
    if vessel.crossflow is None:
        return vessel.quadratic_sway
    return vessel.quadratic_sway + _strip(vessel.crossflow) * vessel.crossflow.length_m


def _quadratic_yaw(vessel: Vessel) -> float:
    """Growth of the linear part, quadratic part, and cross-flow of a vessel turning on the spot."""
    drag = vessel.quadratic_yaw + vessel.linear_yaw * vessel.yaw_linear_growth
    if vessel.crossflow is None:
        return drag
    return drag + _strip(vessel.crossflow) * vessel.crossflow.length_m**4 / 32.0


def _strip(flow: CrossFlow) -> float:
    """Cross-flow drag of a metre of length at 1 m/s [N s2/m3]."""
    return 0.5 * flow.water_density_kgpm3 * flow.coefficient * flow.draft_m


def _disc_kgpm(vessel: Vessel) -> float:
    return vessel.power.disc_kgpm if vessel.power else 0.0


def _top_speed(vessel: Vessel, moored: float, share: float = 1.0) -> float:
    """Speed at which surge drag takes a share of the thrust of both sides [m/s].

    `moored`: thrust of one side [N], above 0.
    """
    drag = vessel.linear_surge, vessel.quadratic_surge
    return _balance(*drag, 2.0 * share, moored, 1.0, _disc_kgpm(vessel))


def _top_rate(vessel: Vessel, share: float = 1.0) -> float:
    """Rate at which yaw drag takes a share of the moment of equal thrusts ahead and astern
    [rad/s].
    """
    low, high = vessel.thruster.thrust_range
    drag, lever = (vessel.linear_yaw, _quadratic_yaw(vessel)), vessel.lever_m
    return _balance(*drag, 2.0 * lever * share, min(high, -low), lever, _disc_kgpm(vessel))


def _balance(
    linear: float, quadratic: float, gain: float, moored: float, lever: float, disc: float
) -> float:
    """Speed v at which drag takes `gain` times a propeller's thrust at `lever` v, by halving."""
    low, high = 0.0, _speed(linear, quadratic, gain * moored)
    while high - low > 1e-12 * high:
        v = 0.5 * (low + high)
        left = gain * thrust_under_way(moored, lever * v, disc) - (linear + quadratic * v) * v
        low, high = (v, high) if left > 0.0 else (low, v)
    return high


def _speed(linear: float, quadratic: float, load: float) -> float:
    """Speed at which linear + quadratic drag takes a load."""
    if quadratic < 1e-12 * linear:
        return load / linear
    root = math.sqrt(linear * linear + 4.0 * quadratic * load)
    return (root - linear) / (2.0 * quadratic)
