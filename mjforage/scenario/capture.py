"""Capture probability of a vessel: the file that `mjforage calibrate` writes, and its cells.

A cell is where an item lies when the hull sets out for it: the quays beside it, the bearing off the
bow and the distance from midships. A hull that stays for an item is no longer where it set out, so
each cell counts what was taken in the first decision, the second and the third.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal, get_args

from mjforage.base.errors import UserError
from mjforage.base.fields import Above, Within
from mjforage.base.toml_files import read_toml
from mjforage.scenario.schema import check
from mjforage.scenario.vessel_files import capture_path

Quays = Literal["open", "straight", "corner"]
QUAYS: tuple[Quays, ...] = get_args(Quays)
FROM_M, FROM_DEG = (0.0, 1.5, 3.0, 5.0), (0.0, 45.0, 90.0, 135.0)  # where cells begin
BESIDE_M = 0.6  # a quay nearer than that to an item is beside it, as for the pilots
DECISIONS = 3  # in which a hull tries for an item; a fourth is like the third
_Count = Annotated[int, Within(0, 1_000_000, "items")]
_Trials = Annotated[int, Within(1, 1_000_000, "items")]


@dataclass(frozen=True)
class CaptureCell:
    """Results of trials with one item."""

    quays: Quays
    """Quays within 0.6 m of the item: none, one, or two that meet."""
    from_m: Annotated[float, Within(0, 1e3, "m")]
    """Least distance of the item from midships; the cell ends where the next one begins."""
    from_deg: Annotated[float, Within(0, 180, "deg")]
    """Least bearing of the item off the bow, to either side; it ends where the next one begins."""
    trials: _Trials
    """Number of trials, each with one item."""
    taken: tuple[_Count, _Count, _Count]
    """Items collected in the first decision, the second and the third."""


@dataclass(frozen=True)
class CaptureFollow:
    """Results of trials with two items in a node."""

    quays: Quays
    """The quays beside each of them."""
    trials: _Trials
    """Trials in which at least one item was collected in the first decision."""
    taken: _Count
    """Trials in which both were collected in the first decision."""


@dataclass(frozen=True)
class Capture:
    """Capture probability of a vessel."""

    period_s: Annotated[float, Above(0, 1e6, "s")]
    """Time of one decision."""
    cells: tuple[CaptureCell, ...]
    """Every combination of quays, from_m and from_deg once."""
    follows: tuple[CaptureFollow, ...]
    """Every kind of quays once."""


def load_capture(vessel: str) -> Capture:
    """Capture probability of a vessel, from the file beside its own.

    Raises `UserError` if there is no such vessel, if it was never calibrated, or if the file is not
    a valid one.

    `vessel`: name, or path of a TOML file.
    """
    path, command = capture_path(vessel), f"mjforage calibrate {vessel}"
    if not path.exists():
        raise UserError(f"vessel {vessel}: no {path.name} beside its file; make it: {command}")
    remedy = f"make it again: {command}"
    capture = check(Capture, read_toml(path, path.name), path.name, remedy=remedy)
    fault = _fault(capture)
    if fault:
        raise UserError(f"{path.name}: {fault}; {remedy}")
    return capture


def usual_capture(vessel: str) -> Capture:
    """Capture probability of a vessel or, if it was never calibrated, of the shipped forager.

    Raises `UserError` if there is no such vessel, or if its file is not a valid one.
    """
    return load_capture(vessel if capture_path(vessel).exists() else "forager")


def _fault(capture: Capture) -> str:
    """First fault that no range shows: a place not listed once, or more taken than tried; or ""."""
    places = [(cell.quays, cell.from_m, cell.from_deg) for cell in capture.cells]
    kinds = [follow.quays for follow in capture.follows]
    for cell, place in zip(capture.cells, places, strict=True):
        if sum(cell.taken) > cell.trials:
            return f"cells {place}: {sum(cell.taken)} taken of {cell.trials} trials"
    for follow in capture.follows:
        if follow.taken > follow.trials:
            return f"follows {follow.quays}: {follow.taken} taken of {follow.trials} trials"
    if sorted(places) != sorted(itertools.product(QUAYS, FROM_M, FROM_DEG)):
        return "cells are not every combination of quays, from_m and from_deg once"
    return "" if sorted(kinds) == sorted(QUAYS) else "follows are not every kind of quays once"


def capture_text(capture: Capture, head: Sequence[str]) -> str:
    """The file of a capture model; `head`: comments to begin with."""
    cells = "\n".join(
        f'  {{ quays = "{c.quays}", from_m = {c.from_m}, from_deg = {c.from_deg}, '
        f"trials = {c.trials}, taken = {list(c.taken)} }},"
        for c in capture.cells
    )
    follows = "\n".join(
        f'  {{ quays = "{f.quays}", trials = {f.trials}, taken = {f.taken} }},'
        for f in capture.follows
    )
    lines = (*head, f"period_s = {capture.period_s}", f"follows = [\n{follows}\n]")
    return "\n".join((*lines, f"cells = [\n{cells}\n]\n"))
