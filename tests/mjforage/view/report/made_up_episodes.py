"""Episodes made up by chance: their rows in the tables and their replay."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.mission.scoring import chosen_metrics
from mjforage.runs.episode_recording import Recording

FLOATS = tuple(one.key for one in chosen_metrics())
COURSES = tuple(one.series_name() for one in chosen_metrics() if one.has_series())


@dataclass(frozen=True)
class Plan:
    """Contents of a made-up episode."""

    policies: tuple[str, ...] = ("greedy", "levy")
    worlds: tuple[str, ...] = ("graph",)
    episodes: int = 3
    horizon: int = 12
    scouts: int = 2
    foragers: int = 2
    name: str = "comb-port"
    shape: tuple[int, int] = (13, 10)
    items: int = 12
    replays: tuple[str, ...] | None = None  # policies with a replay file; None: all
    kept: tuple[int, ...] = (0,)  # episodes with one


def port(shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Basins between fingers: land ring, and every fourth row a quay from the right."""
    mask = np.zeros(shape, dtype=bool)
    mask[1:-1, 1:-1] = True
    for row in range(4, shape[0] - 3, 4):
        mask[row, max(3, shape[1] // 3) : -1] = False
    return mask


def _walk(
    rng: np.random.Generator, mask: NDArray[np.bool_], steps: int, stride: int
) -> NDArray[np.int64]:
    spots = np.argwhere(mask)
    path = [spots[rng.integers(min(8, len(spots)))]]
    move = rng.integers(-1, 2, 2)
    for _ in range(steps):
        here = path[-1]
        for _ in range(12):
            target = here + stride * move
            inside = (target >= 0).all() and (target < mask.shape).all()
            if inside and mask[tuple(target)] and rng.random() < 0.85:
                here = target
                break
            move = rng.integers(-1, 2, 2)
        path.append(here)
    return np.array(path)


@dataclass
class Episode:
    tables: dict[str, list[dict[str, Any]]]
    replay: Recording


def made_up_episode(plan: Plan, world: str, policy: str, episode: int, skill: float) -> Episode:
    """Items are discovered and served by chance; PTA, NT, CSR and length follow from that.

    All other metrics are some number, the same at all steps.
    """
    rng = np.random.default_rng([episode, plan.policies.index(policy), plan.worlds.index(world)])
    count, horizon, agents = plan.items, plan.horizon, plan.scouts + plan.foragers
    mask, times = port(plan.shape), np.arange(horizon + 1)
    key = {"world": world, "policy": policy, "episode": episode}
    spots = np.argwhere(mask)
    start = spots[rng.integers(len(spots), size=count)] + rng.uniform(-0.4, 0.4, (count, 2))
    found = np.floor(rng.gamma(2.0, 0.14 * horizon / skill, count))
    served = found + np.floor(rng.gamma(1.5, 0.1 * horizon / skill, count)) + 1
    unlucky = episode == plan.episodes - 1 and policy == plan.policies[-1]
    served[(served > horizon) | unlucky | (plan.foragers == 0)] = np.inf
    found[(found > horizon) | (agents == 0)] = np.inf
    length = int(served.max()) if np.isfinite(served).all() else horizon
    finder = rng.integers(0, max(1, agents), count)
    server = plan.scouts + rng.integers(0, max(1, plan.foragers), count)
    gone, seen = served <= times[:, None], found <= times[:, None]
    pta_d, pta_c = 100 * seen.mean(1), 100 * gone.mean(1)
    by_scout = (gone & (finder < plan.scouts)).sum(1)
    csr = np.where(gone.any(1), by_scout / np.maximum(gone.sum(1), 1), np.nan)
    series = {"pta_d": pta_d, "pta_c": pta_c, "csr": csr}
    other = np.full(len(times), rng.uniform(0.29, 0.31) / skill)
    steps = [
        {**key, "step": t, **{n: float(series.get(n, other)[t]) for n in COURSES}} for t in times
    ]
    reached = [np.argmax(pta_c >= x) / horizon if pta_c[-1] >= x else 1.0 for x in (50, 90)]
    scalars = {name: values[-1] for name, values in series.items()}
    scalars |= {"nt50": reached[0], "nt90": reached[1], "length": length}
    scalars |= {"cleared": float(gone[-1].all())}

    def whole(value: float) -> int | None:
        return int(value) if np.isfinite(value) else None

    items = [
        {
            **key,
            "item": k,
            "row_start": float(start[k, 0]),
            "col_start": float(start[k, 1]),
            "t_discovered": whole(found[k]),
            "discovered_by": int(finder[k]) if np.isfinite(found[k]) else None,
            "t_collected": whole(served[k]),
            "collected_by": int(server[k]) if np.isfinite(served[k]) else None,
        }
        for k in range(count)
    ]
    tracks = [_walk(rng, mask, length, 1 + (a < plan.scouts)) for a in range(agents)]
    poses = [
        {
            **key,
            "step": t,
            "agent": a,
            "node": 0,
            "x_m": 4.0 * float(track[t, 1]),
            "y_m": 4.0 * (mask.shape[0] - 1 - float(track[t, 0])),
            "direction": 0 if t else None,
            "outcome": "arrived" if t else "start",
            "speed_mps": 0.4 * min(t, 1),
            "collisions": 0,
            "impact_mps": 0.0,
            "work_j": 100.0 * t,
        }
        for a, track in enumerate(tracks)
        for t in range(length + 1)
    ]
    some = {n: float(scalars.get(n, other[0])) for n in FLOATS}
    episodes = [{**key, "items": count, **some}]
    tables = {"episodes": episodes, "steps": steps, "items": items, "agents": poses}
    recording = _replay(plan, world, policy, episode, mask, tracks, start, gone, seen, length)
    return Episode(tables, recording)


def _replay(
    plan: Plan,
    world: str,
    policy: str,
    episode: int,
    mask: NDArray[np.bool_],
    tracks: list[NDArray[np.int64]],
    start: NDArray[np.float64],
    gone: NDArray[np.bool_],
    seen: NDArray[np.bool_],
    length: int,
) -> Recording:
    agents, shape = plan.scouts + plan.foragers, mask.shape
    places = np.stack(tracks, 1) if tracks else np.zeros((length + 1, 0, 2))
    rows, cols = np.indices(shape)
    view = np.zeros((length + 1, *shape), np.uint8)
    belief = np.zeros((length + 1, *shape), np.int16)
    nodes = np.rint(start).astype(int)
    for t in range(length + 1):
        for a in range(agents):
            reach, bit = (4.0, 1) if a < plan.scouts else (1.0, 2)
            row, col = places[t, a]
            view[t] |= np.where(np.hypot(rows - row, cols - col) <= reach, bit, 0).astype(np.uint8)
        view[t] *= mask
        known = nodes[seen[t] & ~gone[t]]
        np.add.at(belief[t], (known[:, 0], known[:, 1]), 1)
    idle = np.where(mask, 0.5, 0.0).astype(np.float16)
    return Recording(
        navigable=mask,
        pitch_m=4.0,
        horizon=plan.horizon,
        period_s=10.0,
        team_names=("scouts", "foragers"),
        agent_team=np.array([int(a >= plan.scouts) for a in range(agents)], dtype=np.int64),
        agent_collects=np.array([a >= plan.scouts for a in range(agents)], dtype=bool),
        agent_rc=places.astype(np.float32),
        item_rc=np.repeat(start[None].astype(np.float32), length + 1, 0),
        item_present=~gone[: length + 1],
        belief=belief,
        idleness=np.repeat(idle[None], length + 1, 0),
        in_view=view,
        vessels=("scout",) * plan.scouts + ("forager",) * plan.foragers,
        item_class=np.zeros(len(start), np.int16),
        frame_s=10.0,
        track_pose=np.zeros((length + 1, agents, 3), np.float32),
        track_items=np.zeros((length + 1, len(start), 2), np.float32),
        track_present=~gone[: length + 1],
        track_wind=np.zeros((length + 1, 2), np.float32),
        world=world,
        policy=policy,
        episode=episode,
        t_discovered=np.where(
            (seen | gone)[: length + 1].any(axis=0), (seen | gone)[: length + 1].argmax(axis=0), -1
        ).astype(np.int16),
    )
