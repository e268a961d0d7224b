"""The checks that the physics is judged by, run on the real code, and their report."""

from mjforage.validation.finding import Finding, Measure
from mjforage.validation.running import run_checks
from mjforage.validation.writing import check_folder, write_validation

__all__ = ["Finding", "Measure", "check_folder", "run_checks", "write_validation"]
