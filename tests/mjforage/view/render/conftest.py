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
RADII = (4.0, 1.0)  # scouts, foragers [node]


def make_recording(
    navigable: NDArray[np.bool_],
    *,
    steps: int = 30,
    items: int = 40,
    agents: tuple[int, int] = (2, 2),
    seed: int = 1,
    spread: float = 4.5,
) -> Recording:
    """Simulate something that looks like an episode; agents walk straight until blocked."""
    rng = np.random.Generator(np.random.PCG64(seed))
    water = np.argwhere(navigable)
    collects = np.repeat([False, True], agents)
    places = _wander(navigable, water, collects, steps, rng)
    centre = water[rng.integers(len(water))]
    start = _on_water(centre + spread * rng.standard_normal((items, 2)), water)
    drift = rng.uniform(-0.08, 0.08, 2)
    item_rc = [start]
    for _ in range(steps):
        moved = item_rc[-1] + drift + rng.uniform(-0.09, 0.09, start.shape)
        item_rc.append(_on_water(moved, water))
    shape = (steps + 1, *navigable.shape)
    present = np.ones((steps + 1, items), np.bool_)
    belief, idleness = np.zeros(shape, np.int16), np.zeros(shape, np.float16)
    view = np.zeros(shape, np.uint8)
    grid = np.indices(navigable.shape)
    for t in range(steps + 1):
        for place, collector in zip(places[t], collects, strict=True):
            distance = np.hypot(grid[0] - place[0], grid[1] - place[1])
            near = (distance <= RADII[int(collector)]) & navigable
            view[t][near] |= 2 if collector else 1
        node = np.rint(item_rc[t]).astype(int)
        if t > 0:
            hit = (node[:, None] == places[t][collects][None]).all(axis=2).any(axis=1)
            present[t] = present[t - 1] & ~hit
            belief[t] = belief[t - 1]
        count = np.zeros(navigable.shape, np.int16)
        np.add.at(count, tuple(node[present[t]].T), 1)
        belief[t][view[t] > 0] = count[view[t] > 0]
        before = idleness[t - 1] + np.float16(1 / (0.9 * 150)) if t else np.float16(1)
        idleness[t] = np.where(navigable & (view[t] == 0), np.minimum(before, 1), 0)
    rows, item_path = navigable.shape[0], np.array(item_rc)
    node = np.rint(item_path).astype(int)
    in_view = view[np.arange(steps + 1)[:, None], node[..., 0], node[..., 1]] > 0
    found = in_view | ~present  # removed unseen counts as discovered
    t_discovered = np.where(found.any(axis=0), found.argmax(axis=0), -1).astype(np.int16)
    pose = np.concatenate((_metres(places, rows), _yaws(places)[..., None]), axis=-1)
    return Recording(
        navigable=navigable,
        pitch_m=PITCH_M,
        horizon=max(150, steps),
        period_s=10.0,
        team_names=("scouts", "foragers"),
        agent_team=collects.astype(np.int64),
        agent_collects=collects,
        agent_rc=places.astype(np.float32),
        item_rc=np.array(item_rc, np.float32),
        item_present=present,
        belief=belief,
        idleness=idleness,
        in_view=view,
        vessels=tuple("forager" if collector else "scout" for collector in collects),
        item_class=np.arange(items, dtype=np.int16) % 5,
        frame_s=10.0,
        track_pose=pose.astype(np.float32),
        track_items=_metres(item_path, rows).astype(np.float32),
        track_present=present,
        track_wind=np.zeros((steps + 1, 2), np.float32),
        policy="greedy",
        episode=3,
        t_discovered=t_discovered,
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


def _on_water(rc: NDArray[np.float64], water: NDArray[np.int64]) -> NDArray[np.float64]:
    nearest = np.argmin(np.square(rc[:, None] - water[None]).sum(axis=2), axis=1)
    centre = water[nearest]
    return np.asarray(np.clip(rc, centre - 0.49, centre + 0.49), np.float64)


def _wander(
    navigable: NDArray[np.bool_],
    water: NDArray[np.int64],
    collects: NDArray[np.bool_],
    steps: int,
    rng: np.random.Generator,
) -> NDArray[np.int64]:
    moves = np.array([(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1)])
    place = water[rng.integers(len(water), size=len(collects))]
    heading = moves[rng.integers(9, size=len(collects))]
    track = [place]
    for _ in range(steps):
        place = place.copy()
        for agent, collector in enumerate(collects):
            for _move in range(1 if collector else 2):
                ahead = place[agent] + heading[agent]
                inside = (ahead >= 0).all() and (ahead < navigable.shape).all()
                if inside and navigable[tuple(ahead)] and rng.random() > 0.06:
                    place[agent] = ahead
                else:
                    heading[agent] = moves[rng.integers(9)]
        track.append(place)
    return np.array(track)


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
    recording: Recording, agents: NDArray[np.floating], items: NDArray[np.floating] | None = None
) -> Recording:
    """The same episode with vessels, and items, on other ways (step, ..., 2) of nodes."""
    rows, pose = len(recording.navigable), np.zeros((*agents.shape[:2], 3), np.float32)
    pose[..., :2], pose[..., 2] = _metres(agents, rows), _yaws(agents)
    changed: dict[str, Any] = {"agent_rc": agents.astype(np.float32), "track_pose": pose}
    if items is not None:
        changed["item_rc"] = items.astype(np.float32)
        changed["track_items"] = _metres(items, rows).astype(np.float32)
    return replace(recording, **changed)
