"""The checks that the physics is judged by, run on the real code, for `mjforage validate`."""

from mjforage.physics.validation.finding import Finding, Measure
from mjforage.physics.validation.runner import run_checks

__all__ = ["Finding", "Measure", "run_checks"]
