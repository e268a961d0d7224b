"""Manoeuvres of one vessel on open water: schedules, standard tests, trajectories, key figures."""

from mjforage.physics.manoeuvre.command import manoeuvre, parse_flow
from mjforage.physics.manoeuvre.key_figures import key_figures
from mjforage.physics.manoeuvre.schedule import Schedule, read_schedule
from mjforage.physics.manoeuvre.standard import STANDARD_TESTS
from mjforage.physics.manoeuvre.trajectory import Trajectory, check_file, write_trajectory
from mjforage.physics.manoeuvre.trial import run_manoeuvre, run_test

__all__ = [
    "STANDARD_TESTS",
    "Schedule",
    "Trajectory",
    "check_file",
    "key_figures",
    "manoeuvre",
    "parse_flow",
    "read_schedule",
    "run_manoeuvre",
    "run_test",
    "write_trajectory",
]
