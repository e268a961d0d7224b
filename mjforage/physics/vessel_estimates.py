"""A whole vessel from a few numbers; rules and their sources stand in `estimated_vessel.toml`."""

import math
import tomllib
from importlib import resources

from mjforage.base.errors import UserError
from mjforage.controllers.propulsion import WATER_DENSITY_KGPM3, thrust_under_way
from mjforage.physics.vessel_models import control_table
from mjforage.physics.vessels import Vessel, check_vessel
from mjforage.scenario.schema import check

_FILLED = 0.2  # of length x beam x draught
_LOADING_NPM2 = 4000.0  # thrust per area of a propeller
_GRAVITY_MPS2 = 9.81
_SOUND = (
    ("length / beam", 0.8, 20.0),
    ("draught / beam, with the draught mass / (water density x 0.2 x length x beam),", 0.01, 1.0),
    ("thrust / mass [m/s2]", 0.01, 9.81),
    ("Froude number, top speed / (9.81 m/s2 x length)^0.5,", 0.01, 1.5),
)
"""Ratios of boats, and estimates of their ranges; the shipped otter has 1.9, 0.17, 3.0 and 0.7."""
_EFFICIENCY = 0.408  # of a motor: power of momentum theory over electrical power


def estimate_vessel(
    length_m: float, beam_m: float, mass_kg: float, thrust_n: float, top_speed_mps: float
) -> str:
    """Text of a vessel's file; every number that is not given is marked as an estimate.

    Raises `UserError` if a number is out of its range, or no body can have them together.

    Parameters
    ----------
    length_m, beam_m, mass_kg : of a catamaran with two thrusters, payload included
    thrust_n : of both thrusters together, moored, ahead
    top_speed_mps : with that command, under way
    """
    given = {"length": length_m, "beam": beam_m, "mass": mass_kg}
    for name, value in (given | {"thrust": thrust_n, "top-speed": top_speed_mps}).items():
        if not 0.0 < value < 1e6:
            raise UserError(
                f"{name} = {value:g}: out of range; give a number above 0 and below 1e6"
            )
    side, rho = 0.5 * thrust_n, WATER_DENSITY_KGPM3
    draft = mass_kg / (rho * _FILLED * length_m * beam_m)
    ratios = length_m / beam_m, draft / beam_m, thrust_n / mass_kg
    for value, (what, low, high) in zip(
        (*ratios, top_speed_mps / math.sqrt(_GRAVITY_MPS2 * length_m)), _SOUND, strict=True
    ):
        if not low <= value <= high:
            raise UserError(
                f"{what} = {value:.3g}: these rules are for boats of {low:g} to {high:g}; check "
                "the numbers and their units"
            )
    disc_m2 = side / _LOADING_NPM2
    disc = 2.0 * rho * disc_m2
    under_way = 2.0 * thrust_under_way(side, top_speed_mps, disc)
    added_sway = 1.1 * rho * length_m * draft**2
    template = resources.files(__package__).joinpath("estimated_vessel.toml")
    text = template.read_text(encoding="utf-8").format(
        **given,
        top=top_speed_mps,
        thrust=thrust_n,
        side=side,
        draft=draft,
        inertia=mass_kg * (0.25 * length_m) ** 2,
        added_surge=0.065 * mass_kg,
        added_sway=added_sway,
        added_yaw=0.07 * added_sway * length_m**2,
        linear_sway=0.41 * rho * length_m * draft,
        linear_yaw=0.0165 * rho * length_m**3 * draft,
        under_way=under_way,
        quadratic_surge=under_way / top_speed_mps**2,
        quadratic_sway=0.55 * rho * length_m * draft,
        quadratic_yaw=0.077 * rho * length_m**4 * draft,
        lever=0.36 * beam_m,
        astern=0.57 * side,
        front=0.15 * length_m * beam_m,
        aside=0.19 * length_m**2,
        propeller=math.sqrt(4.0 * disc_m2 / math.pi),
        motor=math.sqrt(side**3 / disc) / _EFFICIENCY,
    )
    where = "estimate of a vessel"
    vessel = check(Vessel, tomllib.loads(text), where, name="estimated")
    check_vessel(vessel, where)
    return f"{text}\n{control_table(vessel)}"
