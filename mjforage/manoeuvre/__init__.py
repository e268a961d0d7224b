"""Manoeuvres of one hull on open water: schedules, standard tests, trajectories, key figures."""

from mjforage.manoeuvre.command import manoeuvre
from mjforage.manoeuvre.directions import parse_flow
from mjforage.manoeuvre.figures import KeyFigure, key_figures
from mjforage.manoeuvre.plot import check_plot, manoeuvre_figure
from mjforage.manoeuvre.run import run_manoeuvre, run_test
from mjforage.manoeuvre.schedule import Schedule, read_schedule
from mjforage.manoeuvre.standard import STANDARD_TESTS
from mjforage.manoeuvre.trajectory import (
    Trajectory,
    check_file,
    read_trajectory,
    write_trajectory,
)

__all__ = [
    "STANDARD_TESTS",
    "KeyFigure",
    "Schedule",
    "Trajectory",
    "check_file",
    "check_plot",
    "key_figures",
    "manoeuvre",
    "manoeuvre_figure",
    "parse_flow",
    "read_schedule",
    "read_trajectory",
    "run_manoeuvre",
    "run_test",
    "write_trajectory",
]
