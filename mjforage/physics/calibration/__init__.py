"""Capture probability of a vessel, measured: lone vessels and items at rest."""

from mjforage.physics.calibration.measuring import calibrate
from mjforage.physics.calibration.trials import Trials, collected_in

__all__ = ["Trials", "calibrate", "collected_in"]
