"""What the report's interactive replay shows: one episode of every world and policy, made small."""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from markupsafe import Markup
from numpy.typing import NDArray

from graph_planner.references import file_label
from mjforage.core.errors import UserError
from mjforage.core.vessel_files import vessel_names
from mjforage.physics.vessels import load_vessel
from mjforage.runs.episode_replay import Replay
from mjforage.runs.held import Held
from mjforage.runs.run_info import REMEDY
from mjforage.view.page import style
from mjforage.view.report.run_logs import RunLogs, Series
from mjforage.view.report.web_stream import Ints, changes, packed, thinned, track

LIMIT = 400_000  # characters of text for one world and policy
POSITION_M, YAW_RAD, WIND_MPS = 0.01, 0.01, 0.01  # what one unit of the data is worth
IDLE_LEVELS = 15  # levels of idleness above 0
MOST_COUNT = 255  # believed items per node; more are shown as this many
ITEM_FRAME_S = 1.0  # items move slowly: no need for more frames than this
HULL_M = 2.0  # length drawn for a user's vessel in a run at graph level
SCRIPTS = ("decode.js", "harbour.js", "draw.js", "camera.js", "player.js")


@dataclass(frozen=True)
class WebReplay:
    """What the template sets."""

    worlds: tuple[str, ...]
    shown: tuple[str, ...]  # worlds of the panels at first: one or two
    policies: tuple[str, ...]
    vessels: tuple[str, ...]  # names
    held: bool  # whether each knows what it has heard only
    episode: int
    data: Mapping[str, Any]  # for the page's script, as JSON
    script: Markup
    stylesheet: Markup


def replay_files(logs: RunLogs) -> dict[Series, Path]:
    """The replay of the lowest episode of every world and policy that has one."""
    files: dict[Series, Path] = {}
    for world, policy in logs.series:
        prefix = f"{world}-{file_label(policy)}-"
        found = {
            int(path.stem.removeprefix(prefix)): path
            for path in (logs.folder / "replay").glob("*.npz")
            if path.stem.startswith(prefix) and path.stem.removeprefix(prefix).isdigit()
        }
        if found:
            files[world, policy] = found[min(found)]
    return files


def web_replay(logs: RunLogs) -> WebReplay | None:
    """Gather the run's replays; None if it holds none.

    Raises
    ------
    UserError
        If a replay cannot be read or is of another run.
    """
    entries: list[dict[str, Any]] = []
    last: Replay | None = None
    for series, path in replay_files(logs).items():
        last = Replay.load(path)
        entries.append(_entry(last, _discovered(logs, series, last, path)))
    if last is None:
        return None
    worlds = tuple(dict.fromkeys(entry["world"] for entry in entries))
    collects = logs.collects()
    return WebReplay(
        worlds=worlds,
        shown=worlds[:1] + worlds[1:][-1:],
        policies=style.ordered(entry["policy"] for entry in entries),
        vessels=tuple(agent.name for agent in logs.run.agents),
        held=any(entry["forgetting"] is not None for entry in entries),
        episode=min(entry["episode"] for entry in entries),
        data={**_stage(logs, last, collects), "replays": entries},
        script=Markup("\n".join(_part(name) for name in SCRIPTS)),
        stylesheet=Markup(_part("player.css")),
    )


def _part(name: str) -> str:
    return (
        resources.files("mjforage.view.report").joinpath("player", name).read_text(encoding="utf-8")
    )


def _stage(logs: RunLogs, replay: Replay, collects: list[bool]) -> dict[str, Any]:
    """What all replays of a run share."""
    rows, columns = replay.navigable.shape
    belief = style.belief_colours()
    return {
        "rows": rows,
        "columns": columns,
        "extent": _extent(replay.navigable),
        "water": "".join("01"[int(cell)] for cell in replay.navigable.ravel()),
        "pitch_m": replay.pitch_m,
        "period_s": replay.period_s,
        "horizon": replay.horizon,
        "units": {"position_m": POSITION_M, "yaw_rad": YAW_RAD, "wind_mps": WIND_MPS},
        "idle_levels": IDLE_LEVELS,
        "agents": [
            {"name": agent.name, "collects": agent.collects, "colour": colour, "length_m": length}
            for agent, colour, length in zip(
                logs.run.agents,
                style.agent_colours(map(style.role, collects)),
                _lengths(logs, replay),
                strict=True,
            )
        ],
        "colours": {
            "water": style.WATER,
            "land": style.LAND,
            "edge": style.QUAY_EDGE,
            "item": style.ITEM,
            "item_rim": style.ITEM_RIM,
            "ink": style.INK,
            "muted": style.MUTED,
            "scout": style.SCOUT,
            "forager": style.FORAGER,
            "lost": style.LOST,
            "belief": [_hex(belief(place)) for place in np.linspace(style.FIRST, 1.0, 12)],
        },
    }


def _extent(navigable: NDArray[np.bool_]) -> dict[str, int]:
    """Outermost rows and columns that are worth showing: the water and one cell around it."""
    rows, columns = (np.flatnonzero(navigable.any(axis=axis)) for axis in (1, 0))
    height, width = navigable.shape
    return {
        "top": max(0, int(rows[0]) - 1),
        "bottom": min(height - 1, int(rows[-1]) + 1),
        "left": max(0, int(columns[0]) - 1),
        "right": min(width - 1, int(columns[-1]) + 1),
    }


def _hex(colour: tuple[float, ...]) -> str:
    return "#" + "".join(f"{round(255 * part):02x}" for part in colour[:3])


def _lengths(logs: RunLogs, replay: Replay) -> list[float]:
    """Hull length of every vessel [m]: as it was run, else as shipped."""
    ran, shipped = logs.run.hull_lengths, vessel_names()
    return [
        ran.get(name) or (load_vessel(name).length_m if name in shipped else HULL_M)
        for name in replay.vessels
    ]


def _discovered(logs: RunLogs, series: Series, replay: Replay, path: Path) -> Ints:
    """Step of every item's discovery as logged, one step past the end if never."""
    rows = logs.select(logs.items, series).filter(pl.col("episode") == replay.episode).sort("item")
    fits = (
        np.array_equal(replay.navigable, logs.run.map.cells)
        and replay.agent_collects.tolist() == logs.collects()
        and len(rows) == replay.item_present.shape[1]
        and (replay.world, replay.policy) == series
    )
    if not fits:
        raise UserError(f"replay {path}: is not of the run in {logs.folder}; {REMEDY}")
    never = len(replay.item_present)
    step: Ints = rows["t_discovered"].cast(pl.Int64).fill_null(never).to_numpy()
    return np.minimum(step, never)


def _entry(replay: Replay, discovered: Ints) -> dict[str, Any]:
    """One replay for the page: as fine in time as the limit allows."""
    stride = max(1, round(min(ITEM_FRAME_S, replay.period_s) / replay.frame_s))
    text = packed(_parts(replay, discovered, stride))
    while len(text) > LIMIT and stride * replay.frame_s < replay.period_s:
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


def _pose_stride(item_stride: int) -> int:
    return max(1, item_stride // 2)


def _parts(replay: Replay, discovered: Ints, stride: int) -> list[Ints]:
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
