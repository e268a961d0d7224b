"""Schedules: commands of each thruster by their start times, read from CSV `t_s,left,right`."""

import math
from bisect import bisect_right
from dataclasses import dataclass
from pathlib import Path

from mjforage.base.errors import UserError
from mjforage.physics.vessels import Vessel

COLUMNS = ("t_s", "left", "right")


@dataclass(frozen=True)
class Schedule:
    """Piecewise constant commands; before the first row the thrusters are stopped."""

    times_s: tuple[float, ...]  # increasing, from 0 on
    commands: tuple[tuple[float, float], ...]  # port, starboard [rad/s or N], each until the next

    def at(self, time_s: float) -> tuple[float, float]:
        """Commands that hold from `time_s` on."""
        row = bisect_right(self.times_s, time_s)
        return self.commands[row - 1] if row else (0.0, 0.0)


def read_schedule(path: str | Path, vessel: Vessel) -> Schedule:
    """Read and check a schedule for one vessel.

    Raises
    ------
    UserError
        If the file cannot be read, has no rows or other columns; if a row is not three finite
        numbers, is not later than the one before, or is out of the thrusters' range.
    """
    where, columns = f"schedule {Path(path).name}", ",".join(COLUMNS)
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (OSError, ValueError) as error:
        raise UserError(
            f"{where}: cannot be read ({error}); give a CSV file with the columns {columns}"
        ) from error
    lines = [(i, line.split(",")) for i, line in enumerate(text.splitlines(), 1) if line.strip()]
    header = [name.strip() for name in lines[0][1]] if lines else []
    if sorted(header) != sorted(COLUMNS):
        raise UserError(f"{where}: has columns {','.join(header) or 'none'}; expected {columns}")
    rows: list[tuple[float, float, float]] = []
    for number, fields in lines[1:]:
        place = f"{where}: line {number}"
        try:
            row = dict(zip(header, map(float, fields), strict=True))
        except ValueError:
            raise UserError(
                f"{place}: {','.join(fields)}; expected a number for each of {','.join(header)}"
            ) from None
        time, left, right = (row[name] for name in COLUMNS)
        _check_row(time, rows[-1][0] if rows else -math.inf, (left, right), vessel, place)
        rows.append((time, left, right))
    if not rows:
        raise UserError(f"{where}: has no row under its header; give at least one command")
    return Schedule(tuple(t for t, _, _ in rows), tuple((left, right) for _, left, right in rows))


def _check_row(
    time_s: float, before_s: float, command: tuple[float, float], vessel: Vessel, row: str
) -> None:
    if not 0.0 <= time_s < math.inf:
        raise UserError(f"{row}: t_s = {time_s:g}; give finite seconds, 0 or later")
    if time_s <= before_s:
        raise UserError(
            f"{row}: t_s = {time_s:g} is not after {before_s:g}; put the rows in order of time"
        )
    low, high = vessel.thruster.command_range
    for side, value in zip(COLUMNS[1:], command, strict=True):
        if not low <= value <= high:  # also catches what is not a number
            raise UserError(
                f"{row}: {side} = {value:g} is out of range for {vessel.name}; "
                f"give {low:g} to {high:g} {vessel.thruster.command_unit}"
            )
