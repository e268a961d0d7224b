"""Capture probability of a vessel, measured: lone vessels and items at rest."""

from mjforage.physics.calibration.ground import Trials, collected_in
from mjforage.physics.calibration.measuring import calibrate

__all__ = ["Trials", "calibrate", "collected_in"]
