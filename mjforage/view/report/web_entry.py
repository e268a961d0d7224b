"""One episode as the page's player reads it: numbers in a short text, as fine as there is room."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording
from mjforage.runs.held import Held
from mjforage.view.report.web_stream import Ints, changes, packed, thinned, track

POSITION_M, YAW_RAD, WIND_MPS = 0.01, 0.01, 0.01  # what one unit of the data is worth
IDLE_LEVELS = 15  # levels of idleness above 0
MOST_COUNT = 255  # believed items per node; more are shown as this many
ITEM_FRAME_S = 1.0  # items move slowly: no need for more frames than this


def entry_of(replay: Recording, discovered: Ints, limit: int | None = None) -> dict[str, Any]:
    """One replay for the page: as fine in time as the limit allows.

    Parameters
    ----------
    discovered : (item,) step of its discovery, one past the end if never
    limit : characters of its text; it is thinned to no less than a frame for each decision
    """
    stride = max(1, round(min(ITEM_FRAME_S, replay.period_s) / replay.frame_s))
    text = packed(_parts(replay, discovered, stride))
    while limit and len(text) > limit and stride * replay.frame_s < replay.period_s:
        stride *= 2
        text = packed(_parts(replay, discovered, stride))
    return {
        "world": replay.world,
        "policy": replay.policy,
        "episode": replay.episode,
        "steps": len(replay.item_present) - 1,
        "frames": len(replay.track_pose),
        "frame_s": replay.frame_s,
        "pose_stride": _pose_stride(stride),
        "item_stride": stride,
        "items": replay.item_present.shape[1],
        "forgetting": None if replay.held is None else replay.held.forgetting,
        "most_believed": int(np.clip(replay.belief, 0, MOST_COUNT).max(initial=0)),
        "text": text,
    }


def cut_entry(replay: Recording, discovered: Ints, limit: int) -> dict[str, Any]:
    """Its beginning, as `entry_of`, so long that the limit holds; `whole` are the steps it had.

    A limit that holds not even a step leaves one.
    """
    whole = steps = len(replay.item_present) - 1
    found = entry_of(replay, discovered, limit)
    while len(found["text"]) > limit and steps > 1:
        steps = max(1, min(steps - 1, int(0.95 * steps * limit / len(found["text"]))))
        early = np.minimum(discovered, steps + 1)
        found = entry_of(_beginning(replay, steps), early, limit) | {"whole": whole}
    return found


def _beginning(replay: Recording, steps: int) -> Recording:
    """The first steps of an episode, and the frames of that time."""
    frames = int(steps * replay.period_s / replay.frame_s + 1e-6) + 1
    by_step = ("agent_rc", "item_rc", "item_present", "belief", "idleness", "in_view")
    by_frame = ("track_pose", "track_items", "track_present", "track_wind")
    held = None if replay.held is None else replay.held.until(steps)
    cut: dict[str, Any] = {name: getattr(replay, name)[: steps + 1] for name in by_step}
    cut |= {name: getattr(replay, name)[:frames] for name in by_frame}
    return replace(replay, held=held, **cut)


def fair_share(sizes: Sequence[int], budget: int) -> int:
    """The limit to which each is cut where all together are more than the budget."""
    left = budget
    for place, size in enumerate(sorted(sizes)):
        among = len(sizes) - place
        if size * among > left:
            return left // among
        left -= size
    return max(sizes, default=0)


def _pose_stride(item_stride: int) -> int:
    return max(1, item_stride // 2)


def _parts(replay: Recording, discovered: Ints, stride: int) -> list[Ints]:
    """All numbers of a replay, in the order in which ``player/decode.js`` reads them."""
    frames = len(replay.track_pose)
    poses = replay.track_pose[thinned(frames, _pose_stride(stride))]
    rare = thinned(frames, stride)
    yaw = np.unwrap(poses[..., 2].astype(np.float64), axis=0)
    idle = np.rint(replay.idleness.astype(np.float32) * IDLE_LEVELS).astype(np.int64)
    return [
        *track(poses[..., :2], POSITION_M),
        *track(yaw, YAW_RAD),
        *track(replay.track_items[rare], POSITION_M),
        *track(replay.track_wind[rare], WIND_MPS),
        _removed(replay.track_present),
        discovered,
        *changes(np.clip(replay.belief, 0, MOST_COUNT)),
        *changes(idle),
        *changes(replay.in_view),
        *([] if replay.held is None else _held_parts(replay.held, replay.navigable.size)),
    ]


def _held_parts(held: Held, cells: int) -> list[Ints]:
    """What each agent knows, and the links: steps are counted from 1, 0 is never."""
    linked = held.linked.astype(np.int64)
    parts = [
        held.known_from.astype(np.int64) + 1,
        *changes(held.heard),
        *changes(linked + np.clip(held.lost, 0, MOST_COUNT)),
    ]
    for agent in range(len(held.known_from)):
        belief, seen = held.maps(agent, cells)
        parts += changes(np.clip(belief, 0, MOST_COUNT))
        parts += changes(np.maximum(seen.astype(np.int64) + 1, 0))
    return parts


def _removed(present: NDArray[np.bool_]) -> Ints:
    """First frame without each item, the number of frames if never: (item,)."""
    gone = ~present
    frame: Ints = np.where(gone.any(axis=0), gone.argmax(axis=0), len(present)).astype(np.int64)
    return frame
