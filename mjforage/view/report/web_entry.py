"""One episode as the page's player reads it (``player/decode.js``): a short text of numbers.

Numbers are whole and not negative, deflated byte plane by byte plane (all lowest bytes first), in
base64. Signed ones are folded first: 0, -1, 1, -2 -> 0, 1, 2, 3.
"""

import base64
import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording
from mjforage.runs.knowledge_record import KnowledgeRecord

Ints = NDArray[np.int64]
POSITION_M, YAW_RAD, WIND_MPS = 0.01, 0.01, 0.01  # what one unit of the data is worth
IDLE_LEVELS = 15  # levels of idleness above 0
MOST_COUNT = 255  # believed items per node; more are shown as this many
ITEM_FRAME_S = 1.0  # items move slowly: no need for more frames than this


def entry_of(recording: Recording, limit: int) -> dict[str, Any]:
    """One episode for the page: as fine in time as the limit allows.

    `limit`: characters of its text; it is thinned to no less than a frame for each decision.
    """
    stride = max(1, round(min(ITEM_FRAME_S, recording.period_s) / recording.frame_s))
    text = packed(_parts(recording, stride))
    while len(text) > limit and stride * recording.frame_s < recording.period_s:
        stride *= 2
        text = packed(_parts(recording, stride))
    return {
        "world": recording.world,
        "policy": recording.policy,
        "episode": recording.episode,
        "steps": len(recording.item_present) - 1,
        "frames": len(recording.track_pose),
        "frame_s": recording.frame_s,
        "pose_stride": max(1, stride // 2),
        "item_stride": stride,
        "items": recording.item_present.shape[1],
        "forgetting": None if recording.knowledge is None else recording.knowledge.forgetting,
        "most_believed": int(np.clip(recording.belief, 0, MOST_COUNT).max(initial=0)),
        "text": text,
    }


def _parts(recording: Recording, stride: int) -> list[Ints]:
    """All numbers of a recording, in the order in which ``player/decode.js`` reads them."""
    frames, never = len(recording.track_pose), len(recording.item_present)
    poses = recording.track_pose[thinned(frames, max(1, stride // 2))]
    rare = thinned(frames, stride)
    yaw = np.unwrap(poses[..., 2].astype(np.float64), axis=0)
    found = recording.t_discovered.astype(np.int64)
    idle = np.rint(recording.idleness.astype(np.float32) * IDLE_LEVELS).astype(np.int64)
    return [
        *track(poses[..., :2], POSITION_M),
        *track(yaw, YAW_RAD),
        *track(recording.track_items[rare], POSITION_M),
        *track(recording.track_wind[rare], WIND_MPS),
        recording.track_present.sum(axis=0),  # first frame without each item
        np.where(found < 0, never, np.minimum(found, never)),  # step of each item's discovery
        *changes(np.clip(recording.belief, 0, MOST_COUNT)),
        *changes(idle),
        *changes(recording.in_view),
        *(
            []
            if recording.knowledge is None
            else _knowledge_parts(recording.knowledge, recording.navigable.size)
        ),
    ]


def _knowledge_parts(record: KnowledgeRecord, cells: int) -> list[Ints]:
    """Beliefs of each agent, and the links: steps are counted from 1, 0 is never."""
    linked = record.linked.astype(np.int64)
    parts = [
        record.known_from.astype(np.int64) + 1,
        *changes(record.received),
        *changes(linked + np.clip(record.lost, 0, MOST_COUNT)),
    ]
    for agent in range(len(record.known_from)):
        belief, seen = record.maps(agent, cells)
        parts += changes(np.clip(belief, 0, MOST_COUNT))
        parts += changes(np.maximum(seen.astype(np.int64) + 1, 0))
    return parts


def packed(parts: Sequence[Ints]) -> str:
    """Numbers of 0 or more, below 2**32, as text."""
    numbers = np.concatenate([part.ravel() for part in parts]).astype("<u4")
    planes = numbers.view(np.uint8).reshape(-1, 4).T
    return base64.b64encode(zlib.compress(planes.tobytes(), 9)).decode("ascii")


def thinned(frames: int, stride: int) -> Ints:
    """Every `stride`-th of so many frames, and the last."""
    wanted: Ints = np.minimum(np.arange(0, frames - 1 + stride, stride), frames - 1)
    return wanted


def track(values: NDArray[np.floating], quantum: float) -> list[Ints]:
    """Values (time, ...) in units of `quantum`: the order of differences, then those, time last.

    Steady motion is shorter in second differences, noise in first ones: whichever sums to less.
    """
    whole = np.moveaxis(np.rint(values.astype(np.float64) / quantum).astype(np.int64), 0, -1)
    first = np.diff(whole, prepend=0)
    second = np.diff(first, prepend=0)
    order = 2 if np.abs(second).sum() < np.abs(first).sum() else 1
    signed = second if order == 2 else first
    return [np.array([order]), np.where(signed < 0, -2 * signed - 1, 2 * signed)]


def changes(layer: NDArray[np.integer]) -> list[Ints]:
    """Grids (step, row, column) of numbers of 0 or more, by what changes; before them all is 0.

    For each step how many cells change; then the cells, as the distance from the one before (the
    first of a step from the grid's start); then their new values.
    """
    flat = layer.reshape(len(layer), -1)
    step, cell = np.nonzero(np.diff(flat.astype(np.int64), axis=0, prepend=0))
    counts = np.bincount(step, minlength=len(flat)).astype(np.int64)
    gaps = np.diff(cell, prepend=0)
    opening = (np.cumsum(counts) - counts)[counts > 0]
    gaps[opening] = cell[opening]
    return [counts, gaps, flat[step, cell].astype(np.int64)]
