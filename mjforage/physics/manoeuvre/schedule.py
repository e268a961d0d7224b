"""Schedules: which command each thruster gets from when on, read from CSV `t_s,left,right`."""

import csv
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
        If the file cannot be read, has no rows or lacks a column; if a row is not three finite
        numbers, is not later than the one before, or is out of the thrusters' range.
    """
    where = f"schedule {Path(path).name}"
    if Path(path).exists() and not Path(path).is_file():
        raise UserError(
            f"{where}: is no file; give a CSV file with the columns {','.join(COLUMNS)}"
        )
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (OSError, ValueError) as error:
        raise UserError(
            f"{where}: cannot be read ({error}); give a CSV file with the columns "
            f"{','.join(COLUMNS)}"
        ) from error
    lines = [(i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip()]
    if not lines:
        raise UserError(f"{where}: is empty; expected the columns {','.join(COLUMNS)}")
    places = _places(_fields(lines[0][1]), where)
    if len(lines) == 1:
        raise UserError(f"{where}: has no row under its header; give at least one command")
    times: list[float] = []
    commands: list[tuple[float, float]] = []
    for number, line in lines[1:]:
        place = f"{where}: line {number}"
        time, left, right = _numbers(_fields(line), places, place)
        _check_row(time, times[-1] if times else None, (left, right), vessel, place)
        times.append(time)
        commands.append((left, right))
    return Schedule(tuple(times), tuple(commands))


def check_schedule(schedule: Schedule, vessel: Vessel) -> None:
    """Whether times increase from 0 on and commands are finite and in the thrusters' range.

    Raises
    ------
    UserError
        Naming the first row that is wrong, counted from 1.
    """
    if not schedule.times_s:
        raise UserError("schedule: is empty; give at least one command")
    before = None
    for i, (time, command) in enumerate(zip(schedule.times_s, schedule.commands, strict=True), 1):
        _check_row(time, before, command, vessel, f"schedule: row {i}")
        before = time


def _check_row(
    time_s: float,
    before_s: float | None,
    command: tuple[float, float],
    vessel: Vessel,
    where: str,
) -> None:
    _check_time(time_s, before_s, where)
    for side, value in zip(COLUMNS[1:], command, strict=True):
        _check_command(value, vessel, f"{where}: {side}")


def _check_time(time_s: float, before_s: float | None, where: str) -> None:
    if not math.isfinite(time_s):
        raise UserError(f"{where}: t_s = {time_s:g} is not finite; give seconds")
    if time_s < 0.0:
        raise UserError(f"{where}: t_s = {time_s:g} is before the start; give 0 or later")
    if before_s is not None and time_s <= before_s:
        raise UserError(
            f"{where}: t_s = {time_s:g} is not after {before_s:g}; put the rows in order of time"
        )


def _check_command(command: float, vessel: Vessel, where: str) -> None:
    low, high = vessel.thruster.command_range
    if not low <= command <= high:  # also catches what is not a number
        unit = vessel.thruster.command_unit
        raise UserError(
            f"{where} = {command:g} is out of range for {vessel.name}; "
            f"give {low:g} to {high:g} {unit}"
        )


def _fields(line: str) -> list[str]:
    return [entry.strip() for entry in next(csv.reader([line]))]


def _places(header: list[str], where: str) -> tuple[int, ...]:
    """Column of each quantity; others are refused, so that a typo does not pass."""
    for name in COLUMNS:
        if header.count(name) != 1:
            problem = "is missing" if name not in header else "is there twice"
            raise UserError(f"{where}: column {name} {problem}; expected {','.join(COLUMNS)}")
    for name in header:
        if name not in COLUMNS:
            raise UserError(f"{where}: unknown column {name!r}; expected {','.join(COLUMNS)}")
    return tuple(header.index(name) for name in COLUMNS)


def _numbers(fields: list[str], places: tuple[int, ...], where: str) -> tuple[float, float, float]:
    if len(fields) != len(COLUMNS):
        raise UserError(f"{where} has {len(fields)} columns, expected {len(COLUMNS)}")
    numbers = []
    for name, place in zip(COLUMNS, places, strict=True):
        try:
            number = float(fields[place])
        except ValueError:
            raise UserError(f"{where}: {name} = {fields[place]!r}, expected a number") from None
        if not math.isfinite(number):
            raise UserError(f"{where}: {name} = {fields[place]} is not finite; give a number")
        numbers.append(number)
    return numbers[0], numbers[1], numbers[2]
