"""A trajectory of a vessel, row by row, and its CSV table."""

import csv
import io
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mjforage.base.atomic_files import atomic_write
from mjforage.base.errors import UserError
from mjforage.physics.hydrodynamics.conditions import Conditions
from mjforage.physics.vessels import Vessel

COLUMNS = ("t_s", "x_m", "y_m", "yaw_rad", "surge_mps", "sway_mps", "yaw_rate_radps")


@dataclass(frozen=True)
class Trajectory:
    """One vessel's motion, at midships: world x east, y north; yaw unwrapped, counter-clockwise."""

    vessel: Vessel
    conditions: Conditions
    test: str  # name of the standard test, or "schedule"
    times_s: NDArray[np.float64]  # (rows,) from 0 on, at most 0.05 s apart
    states: NDArray[np.float64]  # (rows, 6) in the order of COLUMNS, velocities over ground
    commands: NDArray[np.float64]  # (rows, 2) port, starboard from this row on [rad/s or N]

    @property
    def through_water(self) -> NDArray[np.float64]:
        """(rows, 2) surge and sway relative to the water [m/s]."""
        yaw = self.states[:, 2]
        east, north = self.conditions.current_mps
        forward = np.cos(yaw) * east + np.sin(yaw) * north
        to_port = np.cos(yaw) * north - np.sin(yaw) * east
        return self.states[:, 3:5] - np.stack((forward, to_port), axis=1)


def check_file(path: Path, option: str) -> None:
    """Check before a run that a file of that name can be written.

    Raises
    ------
    UserError
        If it is a folder, its folder is not there, or either may not be written.
    """
    there = path if path.exists() else path.parent
    if path.is_dir() or not path.parent.is_dir() or not os.access(there, os.W_OK):
        raise UserError(
            f"{option} {path}: cannot be written; name a file in a folder that exists and that you "
            "may write to"
        )


def write_trajectory(trajectory: Trajectory, path: str | Path) -> None:
    """Write the CSV table, in numbers that read back bit by bit.

    Raises
    ------
    UserError
        If the file cannot be written.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(np.column_stack((trajectory.times_s, trajectory.states)).tolist())
    with atomic_write(Path(path)) as beside:
        beside.write_text(text.getvalue(), encoding="utf-8")
