"""How surely a hull picks up, measured: lone hulls and items at rest."""

from mjforage.physics.calibration.ground import Trials, taken_in
from mjforage.physics.calibration.measuring import calibrate

__all__ = ["Trials", "calibrate", "taken_in"]
