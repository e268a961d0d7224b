"""Running scenes: many simulations of one scene side by side, stepped by MuJoCo."""

from mjforage.physics.simulation.instability import InstabilityError
from mjforage.physics.simulation.integrators import Integrator
from mjforage.physics.simulation.simulation import Simulation

__all__ = ["InstabilityError", "Integrator", "Simulation"]
