"""Vessels scaled by a scenario's factors, for sensitivity and randomisation."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.randomness import Stream, UInt64Array, stream_key, uniform
from mjforage.physics.vessels import ForceThruster, Propeller, Vessel, check_vessel
from mjforage.scenario.scenario import Scale, Spread

_RIGID = ("mass_kg", "inertia_z_kgm2")
_ADDED = ("added_mass_surge_kg", "added_mass_sway_kg", "added_mass_yaw_kgm2")
_DRAG = tuple(
    f"{part}_{axis}" for part in ("linear", "quadratic") for axis in ("surge", "sway", "yaw")
)


def scaled(vessel: Vessel, scale: Scale) -> Vessel:
    """The vessel with its numbers times the factors; with all of them 1 to the bit itself.

    Yaw inertia goes with the mass, which keeps its distribution. Growth of the yaw damping and what
    items aboard add keep their numbers. Raises `UserError` if no body can have the parameters, such
    as a thrust below the dead zone.
    """
    flow, wind = vessel.crossflow, vessel.windage
    factors = dict.fromkeys(_RIGID, scale.mass) | dict.fromkeys(_ADDED, scale.added_mass)
    factors |= dict.fromkeys(_DRAG, scale.drag)
    found = replace(
        vessel,
        **{name: factor * getattr(vessel, name) for name, factor in factors.items()},
        thruster=_weakened(vessel.thruster, scale.thrust),
        crossflow=flow and replace(flow, coefficient=scale.drag * flow.coefficient),
        windage=replace(
            wind,
            area_front_m2=scale.windage * wind.area_front_m2,
            area_side_m2=scale.windage * wind.area_side_m2,
        ),
    )
    check_vessel(found, f"vessel {vessel.name} with physics.scale")
    return found


@kernel
def _deviations(
    keys: UInt64Array, shares: tuple[float, float, float], out: NDArray[np.float64]
) -> None:
    """Draw (episode, vessel, 3) numbers, uniform in +- each share."""
    for e in range(keys.size):
        key = stream_key(keys[e], Stream.VESSELS)
        for v in range(out.shape[1]):
            for part in range(3):
                out[e, v, part] = shares[part] * (2.0 * uniform(key, v, part) - 1.0)


def deviations(spread: Spread, vessels: int, keys: UInt64Array) -> NDArray[np.float64]:
    """Shares (episode, vessel, 3) by which mass, drag and thrust exceed those of the scenario.

    `keys`: (episode,).
    """
    found = np.empty((keys.size, vessels, 3))
    _deviations(keys, (spread.mass, spread.drag, spread.thrust), found)
    return found


def _weakened(thruster: Propeller | ForceThruster, factor: float) -> Propeller | ForceThruster:
    """A propeller turns as fast for less thrust; a force gives way at its lower end."""
    if isinstance(thruster, Propeller):
        k_ahead, k_astern = factor * thruster.k_ahead, factor * thruster.k_astern
        return replace(thruster, k_ahead=k_ahead, k_astern=k_astern)
    return replace(
        thruster,
        max_ahead_newton=factor * thruster.max_ahead_newton,
        max_astern_newton=factor * thruster.max_astern_newton,
    )
