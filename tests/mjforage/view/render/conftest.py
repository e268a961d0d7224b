"""Recordings made up for drawing: wandering vessels, drifting items, true beliefs and views."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording
from mjforage.view.render import film_frame, panel
from mjforage.view.render.track import Track

PITCH_M = 4.0


def make_recording(
    navigable: NDArray[np.bool_],
    *,
    steps: int = 30,
    items: int = 40,
    agents: tuple[int, int] = (2, 2),
    seed: int = 1,
) -> Recording:
    """Something that looks like an episode: vessels and items wander over the water."""
    rng = np.random.Generator(np.random.PCG64(seed))
    water, grid = np.argwhere(navigable), np.indices(navigable.shape)
    collects = np.repeat([False, True], agents)
    places = _wander(water, rng.integers(-1, 2, (steps + 1, len(collects), 2)), rng)
    item_rc = _wander(water, rng.uniform(-0.2, 0.2, (steps + 1, items, 2)), rng)
    node = np.rint(item_rc).astype(int)
    off = np.hypot(*(grid[:, None, None] - np.moveaxis(places, 2, 0)[..., None, None]))
    near = (off <= np.where(collects, 1.0, 4.0)[:, None, None]) & navigable
    view = near[:, ~collects].any(axis=1) + 2 * near[:, collects].any(axis=1).astype(np.uint8)
    hit = (node[:, :, None] == places[:, None, collects]).all(axis=3).any(axis=2)
    present = ~np.maximum.accumulate(hit & (np.arange(steps + 1) > 0)[:, None], axis=0)
    belief = np.zeros((steps + 1, *navigable.shape), np.int16)
    idleness = np.where(navigable, np.ones_like(belief, np.float16), np.float16(0))
    for t in range(steps + 1):
        belief[t], idleness[t] = belief[t - 1], np.minimum(idleness[t - 1] + 0.008, 1) * navigable
        np.add.at(count := np.zeros_like(belief[t]), tuple(node[t, present[t]].T), 1)
        belief[t][view[t] > 0], idleness[t][view[t] > 0] = count[view[t] > 0], 0
    seen = (view[np.arange(steps + 1)[:, None], node[..., 0], node[..., 1]] > 0) | ~present
    recording = Recording(
        navigable=navigable,
        pitch_m=PITCH_M,
        horizon=max(150, steps),
        period_s=10.0,
        team_names=("scouts", "foragers"),
        agent_team=collects.astype(np.int64),
        agent_collects=collects,
        agent_rc=np.zeros(0, np.float32),
        item_rc=np.zeros(0, np.float32),
        item_present=present,
        belief=belief,
        idleness=idleness,
        in_view=view.astype(np.uint8),
        vessels=tuple("forager" if collector else "scout" for collector in collects),
        item_class=np.arange(items, dtype=np.int16) % 5,
        frame_s=10.0,
        track_pose=np.zeros(0, np.float32),
        track_items=np.zeros(0, np.float32),
        track_present=present,
        track_wind=np.zeros((steps + 1, 2), np.float32),
        policy="greedy",
        episode=3,
        t_discovered=np.where(seen.any(axis=0), seen.argmax(axis=0), -1).astype(np.int16),
    )
    return placed(recording, places, item_rc)


def _wander(
    water: NDArray[np.int64], moves: NDArray[np.number], rng: np.random.Generator
) -> NDArray[np.number]:
    """(step, body, 2) places on the water near where `moves` lead from anywhere."""
    way = water[rng.integers(len(water), size=moves.shape[1])] + np.cumsum(moves, axis=0)
    off = np.square(way[:, :, None] - water).sum(axis=3)
    centre = water[off.argmin(axis=2)]
    return (
        np.asarray(np.clip(way, centre - 0.49, centre + 0.49))
        if moves.dtype.kind == "f"
        else centre
    )


def physics_like(recording: Recording, frames_per_step: int = 20) -> Recording:
    """The same episode with a finer track, as the physics world has it."""
    last = len(recording.track_pose) - 1
    place = np.arange(last * frames_per_step + 1) / frames_per_step
    before = np.minimum(place.astype(int), last - 1)
    part = (place - before)[:, None, None]

    def between(values: NDArray[np.float32]) -> NDArray[np.float32]:
        mixed = values[before] + (values[before + 1] - values[before]) * part
        return np.asarray(mixed, np.float32)

    return replace(
        recording,
        world="physics",
        frame_s=recording.period_s / frames_per_step,
        track_pose=between(recording.track_pose),
        track_items=between(recording.track_items),
        track_present=recording.track_present[np.floor(place).astype(int)],
        track_wind=np.zeros((len(place), 2), np.float32),
    )


def _metres(rc: NDArray[np.number], rows: int) -> NDArray[np.float64]:
    x, y = rc[..., 1] * PITCH_M, (rows - 1 - rc[..., 0]) * PITCH_M
    return np.stack((x, y), axis=-1).astype(np.float64)


def _yaws(places: NDArray[np.number]) -> NDArray[np.float64]:
    """Along the last move; at first east."""
    yaw = np.zeros(places.shape[:2])
    for step, move in enumerate(np.diff(places, axis=0), start=1):
        moving = move.any(axis=1)
        yaw[step] = np.where(moving, np.arctan2(-move[:, 0], move[:, 1]), yaw[step - 1])
    return yaw


def track_of_poses(pose: NDArray[np.float64]) -> Track:
    """Poses (F, agent, 3) every half second, no item, still air."""
    frames = len(pose)
    items, wind = np.zeros((frames, 0, 2), np.float32), np.zeros((frames, 2), np.float32)
    return Track(0.5, pose, items, np.zeros(0), 1.0, wind)


@pytest.fixture(scope="session")
def build() -> Callable[..., Recording]:
    """The builder `make_recording`."""
    return make_recording


@pytest.fixture(scope="session")
def refine() -> Callable[..., Recording]:
    """The function `physics_like`."""
    return physics_like


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The words that a panel writes, instead of their letters."""
    words: list[str] = []
    for module in (panel, film_frame):
        monkeypatch.setattr(module, "write", lambda image, text, *at, **how: words.append(text))
    return words


def placed(
    recording: Recording, agents: NDArray[np.number], items: NDArray[np.number] | None = None
) -> Recording:
    """The same episode with vessels, and items, on other ways (step, ..., 2) of nodes."""
    rows, pose = len(recording.navigable), np.zeros((*agents.shape[:2], 3), np.float32)
    pose[..., :2], pose[..., 2] = _metres(agents, rows), _yaws(agents)
    changed: dict[str, Any] = {"agent_rc": agents.astype(np.float32), "track_pose": pose}
    if items is not None:
        changed["item_rc"] = items.astype(np.float32)
        changed["track_items"] = _metres(items, rows).astype(np.float32)
    return replace(recording, **changed)
