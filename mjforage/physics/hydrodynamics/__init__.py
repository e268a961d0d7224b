"""Forces of water, air and thrusters on a vessel: pure kernels on the record of `pack`.

Body axes x forward, y port; forces at midships. Nothing here knows MuJoCo.
"""

from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.thruster import command_for, thrust, thruster_force
from mjforage.physics.hydrodynamics.water_load import (
    hull_force,
    load_drag,
    load_mass,
)
from mjforage.physics.hydrodynamics.wind_load import wind_force

__all__ = [
    "command_for",
    "hull_force",
    "load_drag",
    "load_mass",
    "pack",
    "thrust",
    "thruster_force",
    "wind_force",
]
