"""A vessel as its controllers know it: size, inertia, drag, thrusters, tuning; and as a record."""

from dataclasses import dataclass, fields
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mjforage.controllers.records import record_type

FloatArray: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class Tuning:
    """The numbers of a vessel's controllers that are chosen, not measured."""

    cruise_ahead_mps: float  # speed over ground on a long leg
    cruise_astern_mps: float
    acceleration_mps2: float  # of the speed's reference
    brake_mps2: float  # deceleration that is always at hand; stopping distances count on it
    yaw_rate_radps: float  # of the heading's reference
    yaw_acceleration_radps2: float
    heading_bandwidth_radps: float
    heading_damping: float
    heading_integral_s: float  # time in which a steady moment is found
    speed_bandwidth_radps: float
    speed_integral_s: float
    lookahead_m: float  # of the line-of-sight guidance
    drift_gain_mps: float  # kappa of its integral
    hold_bandwidth_radps: float  # of keeping position
    hold_integral_s: float
    hold_radius_m: float  # how far beside its place a vessel may lie before it turns
    clearance_m: float  # wanted between vessels, and between vessel and quay
    filter_s: float  # time constant of the filters on measured position and heading


@dataclass(frozen=True)
class VesselModel:
    """The numbers of one vessel that controllers need.

    Inertia includes added mass; drag is `(linear + quadratic |v|) v` along each axis. The thrust of
    one side moored is `k c |c|^(exponent - 1)` of the command c, with a k for each way, and nothing
    inside the dead zone; under way it falls (`propulsion`).
    """

    length_m: float
    beam_m: float
    mass_surge_kg: float
    mass_sway_kg: float
    inertia_yaw_kgm2: float
    munk_kg: float  # added mass in sway minus that in surge
    offset_kgm: float  # mass times the centre of gravity ahead of midships
    linear_surge: float  # [N s/m]
    quadratic_surge: float  # [N s2/m2]
    linear_sway: float  # [N s/m]
    quadratic_sway: float  # [N s2/m2]
    linear_yaw: float  # [N m s]
    quadratic_yaw: float  # [N m s2]
    lever_m: float  # of each thruster
    lag_s: float
    k_ahead: float  # [N] per command to the exponent
    k_astern: float
    exponent: float  # 1: the command is a force; 2: a propeller's speed
    command_low: float
    command_high: float
    dead_zone: float  # of the command
    disc_kgpm: float  # 2 rho A of a propeller; 0: thrust does not fall with speed
    tuning: Tuning


class ModelRecord(VesselModel, Tuning):
    """Fields of the record `MODEL`: `VesselModel`, its `Tuning`, and values derived for kernels.

    For readers and type checkers; it is never made.
    """

    thrust_low: float  # steady thrust of one side moored, full astern [N]
    thrust_high: float  # and full ahead


_OWN = tuple(entry.name for entry in fields(VesselModel) if entry.name != "tuning")
_TUNED = tuple(entry.name for entry in fields(Tuning))
MODEL = record_type((*_OWN, *_TUNED, "thrust_low", "thrust_high"))
ModelArray: TypeAlias = NDArray[Any]  # (vessel,) of `MODEL`


def packed(model: VesselModel) -> ModelRecord:
    """A model as a record of `MODEL`, SI units."""
    own = [getattr(model, name) for name in _OWN]
    tuned = [getattr(model.tuning, name) for name in _TUNED]
    low = -model.k_astern * abs(model.command_low) ** model.exponent
    high = model.k_ahead * model.command_high**model.exponent
    record: ModelRecord = np.array([(*own, *tuned, low, high)], MODEL)[0]
    return record
