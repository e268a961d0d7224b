"""What happens when in a replay, and where everything is between two steps."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording

TURN_PART = 0.35  # part of a step that a vessel takes to turn
NEVER = np.iinfo(np.int64).max


@dataclass(frozen=True)
class Timeline:
    """Events of one episode of T' steps; `course` is the angle from east, clockwise on screen."""

    length: int  # T' [step]
    discovered: NDArray[np.int64]  # (item,) step, NEVER if not
    known: NDArray[np.int64]  # (item,) the same for those by whose knowledge the replay is drawn
    removed: NDArray[np.int64]  # (item,) step, NEVER if not
    pta_d: NDArray[np.float64]  # (T'+1,) [%]
    pta_c: NDArray[np.float64]  # (T'+1,) [%]
    course: NDArray[np.float64]  # (T'+1, agent) [rad], of the move that ends at the step


def timeline_of(replay: Recording) -> Timeline:
    """Events and courses of a replay; discoveries are as they were logged.

    Raises
    ------
    UserError
        If the replay is of a version that kept no discoveries.
    """
    if replay.t_discovered is None:
        raise UserError(
            f"replay of episode {replay.episode} of {replay.policy} in world {replay.world}: it "
            "tells no discoveries, as it was saved by an earlier version; `mjforage render RUN` "
            "plays the episode again"
        )
    steps, items = replay.item_present.shape
    removed = _first(~replay.item_present)
    discovered = known = _or_never(replay.t_discovered)
    if replay.held is not None and replay.held.shown >= 0:
        known = _or_never(replay.held.known_from[replay.held.shown])
    step = np.arange(steps)[:, None]
    share = 100.0 / max(items, 1)
    return Timeline(
        length=steps - 1,
        discovered=discovered,
        known=known,
        removed=removed,
        pta_d=share * (discovered <= step).sum(axis=1),
        pta_c=share * (removed <= step).sum(axis=1),
        course=courses(replay.agent_rc),
    )


def _or_never(step: NDArray[np.int16]) -> NDArray[np.int64]:
    """Steps with NEVER for those below 0."""
    return np.where(step < 0, NEVER, step.astype(np.int64))


def _first(happened: NDArray[np.bool_]) -> NDArray[np.int64]:
    """First True along axis 0 of (step, item), NEVER without one."""
    first: NDArray[np.int64] = np.where(happened.any(axis=0), happened.argmax(axis=0), NEVER)
    return first


def courses(agent_rc: NDArray[np.float32]) -> NDArray[np.float64]:
    """Course per step (step, agent); a vessel that stays keeps its last, at first its next one."""
    move = np.diff(agent_rc.astype(np.float64), axis=0, prepend=agent_rc[:1].astype(np.float64))
    moving = np.any(move != 0.0, axis=-1)
    course = np.where(moving, np.arctan2(move[..., 0], move[..., 1]), -np.pi / 2.0)
    steps = np.arange(len(course))[:, None]
    last = np.maximum.accumulate(np.where(moving, steps, -1), axis=0)
    first = np.where(moving.any(axis=0), moving.argmax(axis=0), 0)
    return np.take_along_axis(course, np.where(last < 0, first, last), axis=0)


def split_time(time: float, length: int) -> tuple[int, int, float]:
    """Return the step before, the step after and the part of the way between, at `time` [step].

    Raises
    ------
    ValueError
        If `time` lies outside 0..length.
    """
    if not 0.0 <= time <= length:
        raise ValueError(f"time {time} lies outside the episode, 0 to {length} steps")
    before = min(int(time), max(length - 1, 0))
    return before, min(before + 1, length), time - before


def course_at(timeline: Timeline, time: float) -> NDArray[np.float64]:
    """Return courses (agent,) [rad] at `time` [step], turning early in each step."""
    before, after, part = split_time(time, timeline.length)
    turn = (timeline.course[after] - timeline.course[before] + np.pi) % (2.0 * np.pi) - np.pi
    turned: NDArray[np.float64] = timeline.course[before] + turn * min(1.0, part / TURN_PART)
    return turned


def between(values: NDArray[np.float32], time: float) -> NDArray[np.float64]:
    """Interpolate (step, ...) linearly at `time` [step]."""
    before, after, part = split_time(time, len(values) - 1)
    first, second = values[before].astype(np.float64), values[after].astype(np.float64)
    mixed: NDArray[np.float64] = first + (second - first) * part
    return mixed
