"""The counts of a capture model: as many trials in every cell, each of a lone vessel."""

import itertools

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.errors import UserError
from mjforage.mission.capture_rule import capture_cell
from mjforage.physics.calibration.trials import PERIOD_S, PITCH_M, Trials, collected_in, draw
from mjforage.physics.vessels import Vessel, load_vessel
from mjforage.scenario.capture import (
    DECISIONS,
    FROM_DEG,
    FROM_M,
    QUAYS,
    Capture,
    CaptureCell,
    CaptureFollow,
    Quays,
)

FloatArray = NDArray[np.float64]
CELLS = list(itertools.product(range(len(FROM_M)), range(len(FROM_DEG))))
BATCH, MOST_BATCHES = 50_000, 200  # drawn at a time, until every cell has its trials
PAIRS = 4  # trials with two items, over those with one of a cell


def calibrate(vessel: str, trials: int, seed: int) -> Capture:
    """Count the items that a vessel collects in trials.

    Parameters
    ----------
    vessel : name, or path of a TOML file
    trials : in every cell
    seed : of places, headings and noise

    Raises
    ------
    UserError
        If there is no such vessel, or it is too large for a node.
    """
    loaded, cells, follows = load_vessel(vessel), [], []
    for number, quays in enumerate(QUAYS):
        rng = np.random.default_rng((seed, number))
        alone = collected_in(vessel, _in_every_cell(rng, loaded, quays, trials), DECISIONS, seed)
        for (i, j), found in zip(CELLS, alone.reshape(len(CELLS), trials), strict=True):
            first, second, third = np.bincount(found, minlength=DECISIONS)[:DECISIONS].tolist()
            cells.append(CaptureCell(quays, FROM_M[i], FROM_DEG[j], trials, (first, second, third)))
        both = collected_in(vessel, draw(rng, loaded, quays, PAIRS * trials, 2), 1, seed) == 0
        some = int(both.any(axis=1).sum())
        follows.append(CaptureFollow(quays, max(some, 1), int(both.all(axis=1).sum())))
    return Capture(PERIOD_S, tuple(cells), tuple(follows))


def _in_every_cell(rng: np.random.Generator, vessel: Vessel, quays: Quays, trials: int) -> Trials:
    """Trials with one item, in the order of `CELLS`."""
    found: list[list[Trials]] = [[] for _ in CELLS]
    lacking = np.full(len(CELLS), trials)
    for _ in range(MOST_BATCHES):
        drawn = draw(rng, vessel, quays, BATCH)
        cell = _cells(drawn.pose, drawn.items[:, 0])
        for number in np.flatnonzero(lacking):
            rows = np.flatnonzero(cell == number)[: lacking[number]]
            found[number].append(drawn.rows(rows))
            lacking[number] -= rows.size
        if not lacking.any():
            return Trials.joined([part for parts in found for part in parts])
    i, j = CELLS[int(lacking.argmax())]
    raise UserError(
        f"vessel {vessel.name}: cannot lie {FROM_M[i]:g} m from an item ({quays}), {FROM_DEG[j]:g} "
        f"degrees off the bow, in a node of {PITCH_M:g} m; give a smaller vessel"
    )


@kernel
def _cells(pose: FloatArray, items: FloatArray) -> NDArray[np.int64]:
    """(trial,) place of each item (trial, 2) in `CELLS`, seen from poses (trial, 3)."""
    found = np.empty(len(pose), np.int64)
    for n in range(len(pose)):
        i, j = capture_cell(items[n, 0] - pose[n, 0], items[n, 1] - pose[n, 1], pose[n, 2])
        found[n] = i * len(FROM_DEG) + j
    return found
