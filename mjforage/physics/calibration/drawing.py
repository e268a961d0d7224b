"""Starts of trials: vessels anywhere they float free, items at rest, beside quays or not."""

import numpy as np
from numpy.typing import NDArray

from mjforage.physics.calibration.ground import PITCH_M, SIDE, Trials
from mjforage.physics.vessels import Vessel
from mjforage.scenario.capture import QUAYS, Quays

FloatArray = NDArray[np.float64]

MIDDLE_M = 0.5 * (SIDE - 1) * PITCH_M  # centre of the basin's middle node, on both axes
REST_M = (1.85, 1.9)  # from a node's centre, of the middle of an item that rests at its quay
REACH_M = 1.95  # the same at most, along a quay or without one
FREE_M = 0.12  # around a vessel at first; more than the radius of an item


def draw(
    rng: np.random.Generator, vessel: Vessel, quays: Quays, count: int, items: int = 1
) -> Trials:
    """Trials with a vessel anywhere in a node or one beside it, and items in the node.

    Parameters
    ----------
    quays : of `QUAYS`, beside each item
    count : number drawn; those whose vessel would touch a quay or an item are left out
    """
    sides = np.zeros((count, 2))
    for axis in range(QUAYS.index(quays)):
        sides[:, axis] = rng.choice((-1.0, 1.0), count)
    sides = rng.permuted(sides, axis=1)
    node = MIDDLE_M * (1.0 + sides)
    at_quay = sides[:, None] * rng.uniform(*REST_M, (count, items, 2))
    off = np.where(sides[:, None] == 0.0, rng.uniform(-REACH_M, REACH_M, at_quay.shape), at_quay)
    origin = node + PITCH_M * rng.integers(-1, 2, (count, 2))
    midships = origin + 0.5 * PITCH_M * rng.uniform(-1.0, 1.0, (count, 2))
    pose = np.column_stack((midships, rng.uniform(-np.pi, np.pi, count)))
    trials = Trials(pose, node, node[:, None] + off)
    free = _is_afloat(vessel, pose) & ~_touches(vessel, trials)
    return trials.rows(free)


def seen_from_hull(trials: Trials) -> tuple[FloatArray, FloatArray]:
    """(trial, item) how far each item lies ahead of midships, and to port [m]."""
    apart = trials.items - trials.pose[:, None, :2]
    c, s = np.cos(trials.pose[:, 2:]), np.sin(trials.pose[:, 2:])
    return c * apart[..., 0] + s * apart[..., 1], c * apart[..., 1] - s * apart[..., 0]


def _is_afloat(vessel: Vessel, pose: FloatArray) -> NDArray[np.bool_]:
    """(trial,) whether the whole vessel lies in the basin."""
    c, s = np.abs(np.cos(pose[:, 2])), np.abs(np.sin(pose[:, 2]))
    half_length, half_beam = 0.5 * vessel.length_m, 0.5 * vessel.beam_m
    east = np.abs(pose[:, 0] - MIDDLE_M) + c * half_length + s * half_beam
    north = np.abs(pose[:, 1] - MIDDLE_M) + s * half_length + c * half_beam
    inside: NDArray[np.bool_] = np.maximum(east, north) < 0.5 * SIDE * PITCH_M
    return inside


def _touches(vessel: Vessel, trials: Trials) -> NDArray[np.bool_]:
    """(trial,) whether an item lies against the vessel, or in its mouth."""
    ahead, aside = seen_from_hull(trials)
    along = np.abs(ahead) < 0.5 * vessel.length_m + FREE_M
    across = np.abs(aside) < 0.5 * vessel.beam_m + FREE_M
    found: NDArray[np.bool_] = np.any(along & across, axis=1)
    return found
