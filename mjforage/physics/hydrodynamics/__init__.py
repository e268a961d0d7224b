"""Forces of water, air and thrusters on a hull: pure kernels on the record of `pack`.

Body axes x forward, y port; forces at midships. A solver with accelerations in body axes takes
`hull_force`; one with accelerations in world axes and R M_A R^T in its mass matrix, such as MuJoCo,
takes `hull_force_inertial` (see there). Nothing here knows MuJoCo; `reference` integrates the same
forces as a plain ordinary differential equation.
"""

from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.thruster import command_for, thrust, thruster_force
from mjforage.physics.hydrodynamics.water_load import (
    hull_force,
    hull_force_inertial,
    load_drag,
    load_mass,
)
from mjforage.physics.hydrodynamics.wind_load import wind_force

__all__ = [
    "command_for",
    "hull_force",
    "hull_force_inertial",
    "load_drag",
    "load_mass",
    "pack",
    "thrust",
    "thruster_force",
    "wind_force",
]
