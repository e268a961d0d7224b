"""Recorded episodes for tests of the page's player."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from mjforage.base.atomic_files import write_bytes
from mjforage.runs.episode_recording import Recording
from mjforage.runs.knowledge_record import KnowledgeRecord
from mjforage.view.report.run_logs import load_logs
from mjforage.view.report.web_replay import WebReplay, web_replay

MakeRun = Callable[..., Path]
NODE = shutil.which("node")


def finer(replay: Recording, frame_s: float, world: str) -> Recording:
    """The same episode with a track as the physics world has it: smooth, noisy, often turning."""
    rng = np.random.default_rng(7)
    per = round(replay.period_s / frame_s)
    steps, items = replay.item_present.shape
    agents = len(replay.agent_team)
    frames = (steps - 1) * per + 1
    speed = np.cumsum(rng.normal(0.0, 0.01, (frames, agents, 2)), axis=0)
    yaw = np.cumsum(rng.normal(0.0, 0.15, (frames, agents, 1)), axis=0) + 3.0
    drift = 0.08 + 0.02 * rng.normal(size=(frames, items, 2))
    start = 4.0 * rng.uniform(1.0, 40.0, (items, 2))
    late = rng.integers(0, per, items)
    gone = ~replay.item_present
    frame = np.where(gone.any(0), np.maximum(gone.argmax(0) * per - late, 0), frames)
    present = np.arange(frames)[:, None] < frame
    place = start + np.cumsum(np.where(present[..., None], drift * frame_s, 0.0), axis=0)
    return replace(
        replay,
        world=world,
        frame_s=frame_s,
        track_pose=np.concatenate(
            [60.0 + np.cumsum(speed, axis=0) * 0.02, (yaw + np.pi) % (2 * np.pi) - np.pi], axis=-1
        ).astype(np.float32),
        track_items=place.astype(np.float32),
        track_present=present,
        track_wind=rng.normal(0.0, 3.0, (frames, 2)).astype(np.float32),
    )


def with_track(folder: Path, world: str, frame_s: float) -> Recording:
    """Give a world of the run a track of its own, and return that replay."""
    path = folder / "replay" / f"{world}-greedy-0.npz"
    replay = finer(Recording.load(path), frame_s, world)
    write_bytes(path, replay.content())
    return replay


def with_physics(folder: Path) -> Recording:
    return with_track(folder, "physics", 0.5)


def over_link(replay: Recording, seed: int = 4) -> Recording:
    """The same episode with a link made up by chance: who hears what, and what is lost."""
    rng = np.random.default_rng(seed)
    (steps, items), agents = replay.item_present.shape, len(replay.agent_team)
    water, changes = np.flatnonzero(replay.navigable), np.full(steps, 6 * agents, np.int32)
    step = np.repeat(np.arange(steps), changes)
    each = [rng.choice(water, 6, replace=False) for _ in range(steps * agents)]
    linked = np.triu(rng.random((steps, agents, agents)) < 0.5, 1)
    linked |= linked.swapaxes(1, 2)
    heard = np.maximum.accumulate(
        rng.integers(0, np.arange(steps)[:, None, None] + 1, (linked.shape))
    )
    heard[:, range(agents), range(agents)] = np.arange(steps)[:, None]
    held = KnowledgeRecord(
        forgetting=0.05,
        changes=changes,
        agent=np.tile(np.repeat(np.arange(agents), 6), steps).astype(np.int16),
        cell=np.concatenate(each).astype(np.int32),
        seen=np.maximum(step - rng.integers(0, 3, step.size), 0).astype(np.int16),
        items=rng.integers(0, 4, step.size).astype(np.int16),
        received=heard.astype(np.int16),
        known_from=rng.integers(-1, steps, (agents, items)).astype(np.int16),
        linked=linked,
        lost=(linked * rng.integers(0, 3, linked.shape)).astype(np.int16),
    )
    return replace(replay, knowledge=held)


def with_link(folder: Path) -> Recording:
    """Put the run's replay of the graph world over a link, and return it."""
    path = folder / "replay" / "graph-greedy-0.npz"
    replay = over_link(Recording.load(path))
    write_bytes(path, replay.content())
    return replay


def shown(folder: Path) -> WebReplay:
    result = web_replay(load_logs(folder))
    assert result is not None
    return result


def entry_of(result: WebReplay, world: str) -> dict[str, Any]:
    found: dict[str, Any] = next(e for e in result.data["replays"] if e["world"] == world)
    return found
