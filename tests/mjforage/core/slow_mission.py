"""The mission of scenario section 1 in plain Python, one episode at a time: the kernels' oracle.

It shares with the code under test the initial world, the noise numbers and the graph's edges and
views (which have oracles of their own), and nothing else.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from graph_planner.randomness import Stream, episode_keys, stream_key
from mjforage.core.initial_state import item_noise
from mjforage.core.setup import Setup


@dataclass
class Slow:
    """State of one episode, in Python objects."""

    nodes: list[int]
    items: dict[int, tuple[float, float]]
    idleness: NDArray[np.float64]
    belief: NDArray[np.int64]
    found: dict[int, tuple[int, int]] = field(default_factory=dict)
    taken: dict[int, tuple[int, int]] = field(default_factory=dict)
    step: int = 0


class SlowMission:
    """Plays one episode by the book."""

    def __init__(self, setup: Setup, seed: int, episode: int) -> None:
        self.setup, self.graph, self.fleet = setup, setup.graph, setup.fleet
        keys = episode_keys(seed, np.array([episode]))
        world = setup.create_initial_state(keys)
        self.drift = world.drift_rc[0]
        self.noise_key = np.uint64(stream_key(keys[0], Stream.NOISE))
        n = int(world.n_items[0])
        self.state = Slow(
            nodes=world.agent_node[0].tolist(),
            items={k: (world.item_rc[0, k, 0], world.item_rc[0, k, 1]) for k in range(n)},
            idleness=np.ones(len(self.graph)),
            belief=np.zeros(len(self.graph), np.int64),
        )
        self.total = n
        self.travelled = [0.0] * len(self.fleet)
        self._see()

    def node_of(self, position: tuple[float, float]) -> int:
        r, c = (int(np.floor(v + 0.5)) for v in position)
        inside = 0 <= r < self.graph.shape[0] and 0 <= c < self.graph.shape[1]
        return int(self.graph.node_of_cell[r, c]) if inside else -1

    def truth(self) -> NDArray[np.int64]:
        counts = np.zeros(len(self.graph), np.int64)
        for position in self.state.items.values():
            counts[self.node_of(position)] += 1
        return counts

    def views(self, agent: int) -> set[int]:
        task = self.setup.task
        radius = int(task.radius_number[agent])
        return set(task.views.of(self.state.nodes[agent], radius).tolist())

    def move(self, preferences: NDArray[np.float64]) -> None:
        rules, chosen = self.setup.scenario.rules, set[int]()
        for agent in self.fleet.order.tolist():
            here, options = self.state.nodes[agent], {}
            for d in range(8):
                way = [here]
                for _ in range(int(self.fleet.moves[agent])):
                    following = int(self.graph.neighbours[way[-1], d])
                    if following < 0 or following in chosen:
                        break
                    way.append(following)
                whole = len(way) == self.fleet.moves[agent] + 1
                length = (len(way) - 1) * (np.sqrt(2) if d % 2 else 1.0)
                enough = self.travelled[agent] + length <= self.fleet.energy[agent] + 1e-9
                if len(way) > 1 and (whole or rules.shorten) and enough:
                    options[d] = (way[-1], length)
            if rules.stay and here not in chosen:
                options[8] = (here, 0.0)
            best = max(options, key=lambda d, a=agent: preferences[a, d], default=None)  # type: ignore[misc]
            target, length = options[best] if best is not None else (here, 0.0)
            self.state.nodes[agent] = target
            self.travelled[agent] += length
            chosen.add(target)

    def collect(self) -> None:
        for agent in range(len(self.fleet)):
            room = int(self.fleet.capacity[agent]) - sum(
                by == agent for _, by in self.state.taken.values()
            )
            for k in sorted(self.state.items):
                here = self.node_of(self.state.items[k]) == self.state.nodes[agent]
                if self.fleet.collects[agent] and here and room > 0:
                    del self.state.items[k]
                    room -= 1
                    self.state.taken[k] = (self.state.step, agent)
                    self.state.found.setdefault(k, (self.state.step, agent))

    def drift_items(self) -> None:
        strength = self.setup.scenario.weather.noise_node_per_step
        for k, (row, col) in self.state.items.items():
            noise = item_noise(self.noise_key, k, self.state.step)
            row = row + (self.drift[0] + strength * noise[0])
            col = col + (self.drift[1] + strength * noise[1])
            self.state.items[k] = self.pushed_into_water(row, col)

    def pushed_into_water(self, row: float, col: float) -> tuple[float, float]:
        if self.node_of((row, col)) >= 0:
            return row, col
        height, width = self.graph.shape
        row, col = min(max(row, 0.0), height - 1.0), min(max(col, 0.0), width - 1.0)
        squared = (self.graph.rows - row) ** 2 + (self.graph.cols - col) ** 2
        node = int(np.argmin(squared))
        r, c = int(self.graph.rows[node]), int(self.graph.cols[node])
        walls, off = self.setup.scenario.rules.walls, np.array((row - r, col - c))
        if walls == "clip" or abs(off).max() <= 0.49:
            return min(max(row, r - 0.49), r + 0.49), min(max(col, c - 0.49), c + 0.49)
        back = off * (0.49 / abs(off).max())
        if walls == "published":
            smaller = 0 if abs(off[0]) < abs(off[1]) else 1
            back[smaller] = abs(back[smaller]) * np.sign(off.min())
        return r + float(back[0]), c + float(back[1])

    def _see(self) -> None:
        state, truth = self.state, self.truth()
        if state.step > 0:
            growth = 1.0 / (0.9 * self.setup.scenario.horizon)
            state.idleness = np.clip(state.idleness + growth, 0.0, 1.0)
        for agent in [*self.fleet.discoverers.tolist(), *self.fleet.collectors.tolist()]:
            for node in self.views(agent):
                state.idleness[node] = 0.0
                state.belief[node] = truth[node]
            for k, position in state.items.items():
                if k not in state.found and self.node_of(position) in self.views(agent):
                    state.found[k] = (state.step, agent)

    def advance(self, preferences: NDArray[np.float64]) -> None:
        self.state.step += 1
        self.move(preferences)
        self.collect()
        self.drift_items()
        self._see()

    def rmse(self) -> tuple[float, float]:
        grid = np.zeros((2, *self.graph.shape))
        grid[0][self.graph.navigable] = self.truth()
        grid[1][self.graph.navigable] = self.state.belief
        squared = (gaussian_filter(grid[0], 1.0) - gaussian_filter(grid[1], 1.0)) ** 2
        nodes = float(np.sqrt(squared[self.graph.navigable].mean()))
        return nodes, float(np.sqrt(squared.mean(axis=0)).mean())

    def overlap(self, team: NDArray[np.int64]) -> float:
        seen = [node for agent in team.tolist() for node in self.views(agent)]
        distinct = set(seen)
        twice = {node for node in distinct if seen.count(node) >= 2}
        return len(twice) / len(distinct) if distinct else float("nan")
