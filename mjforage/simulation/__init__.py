"""Running scenes: many simulations of one scene side by side, stepped by MuJoCo."""

from mjforage.simulation.errors import InstabilityError
from mjforage.simulation.integrators import Integrator
from mjforage.simulation.simulation import Simulation

__all__ = ["InstabilityError", "Integrator", "Simulation"]
