"""The mission in plain Python, one episode at a time: the kernels' oracle (definitions, section 1).

It shares with the code under test the scenario, the cells of the map, where agents start, and the
numbers of the counter-based streams; what is decided with them is worked out here.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from mjforage.base.randomness import Stream, episode_keys, normal, stream_key
from mjforage.forcing.item_noise import item_noise
from mjforage.mission.moves import FINAL
from mjforage.mission.setup import Setup
from mjforage.scenario.roles import Role
from tests.mjforage.mission.slow_link import SlowLink
from tests.mjforage.mission.slow_map import COMPASS, SlowMap
from tests.mjforage.mission.slow_minds import Mind, Scan, SensorConfig, drawn

STAY = 8


@dataclass
class Agent:
    """One vessel."""

    role: Role
    team: str
    node: int
    yaw: float = 0.0  # to the east, counter-clockwise
    way: float = 0.0  # so far
    taken: int = 0
    took: bool = False  # in this step
    blocked: bool = False
    direction: int = -1
    steps: int = 0

    @property
    def energy_left(self) -> float:
        """Way that it can still go."""
        return max(self.role.energy - self.way, 0.0) if self.role.energy else math.inf

    @property
    def room_left(self) -> float:
        """Items that it can still take."""
        return self.role.capacity - self.taken if self.role.capacity else math.inf


def length_of(direction: int, steps: int) -> float:
    """Way of a move [node]."""
    return steps * math.hypot(*COMPASS[direction]) if direction < STAY else 0.0


class SlowMission:
    """Plays one episode by the book."""

    def __init__(self, setup: Setup, seed: int, episode: int) -> None:
        self.scenario = scenario = setup.scenario
        across = scenario.rules.sight == "disc"
        self.water = SlowMap(setup.grid.navigable, scenario.map.corner_cutting, across)
        keys = episode_keys(seed, np.array([episode]))
        self.key, self.step = int(keys[0]), 0
        starts = setup.create_initial_state(keys).agent_node[0].tolist()
        roles = [(name, role) for name, role in scenario.team.items() for _ in range(role.count)]
        self.agents = [
            Agent(role, name, node) for (name, role), node in zip(roles, starts, strict=True)
        ]
        self.items, self.drift = self._items(), self._drift()
        self.total = len(self.items)
        self.found: dict[int, tuple[int, int]] = {}  # item -> (step, agent)
        self.taken: dict[int, tuple[int, int]] = {}
        self.sensors = SensorConfig(scenario, self.water, self.key)
        self.scans: dict[tuple[int, int], Scan] = {}
        self.pooled = Mind(scenario, self.sensors)
        self.delayed: list[list[Scan]] = []
        self.link, self.minds = None, [self.pooled]
        if scenario.link.model != "ideal":
            relays = [agent.role.relays for agent in self.agents]
            about = scenario.map.pitch_m, scenario.horizon, relays, self.key
            self.link = SlowLink(scenario.link, *about)
            self.minds = [Mind(scenario, self.sensors) for _ in self.agents]
        self.item_nodes: list[dict[int, int]] = []
        self._look()

    def _normal(self, index: int, step: int) -> float:
        stream = stream_key(np.uint64(self.key), Stream.ITEMS)
        return float(normal(np.uint64(stream), index, step))

    def _items(self) -> dict[int, tuple[float, float]]:
        """Items around the hotspots, dealt out in turn."""
        items, cells = self.scenario.items, self.water.cells
        count = round(items.mean + items.std * self._normal(0, 0))
        count = count if count > 0 else items.otherwise
        spread, walls = math.sqrt(items.covariance_node2), self.scenario.rules.walls
        places = {}
        for k in range(count):
            pick = drawn(self.key, Stream.ITEMS, 1 + k % items.hotspots, 1)
            row, col = cells[int(pick * len(cells))]
            off = spread * self._normal(2 * k, 2), spread * self._normal(2 * k + 1, 2)
            places[k] = self.water.pushed_into_water((row + off[0], col + off[1]), walls)
        return places

    def _drift(self) -> tuple[float, float]:
        """(row, column) of the episode's drift [node/step]: 3 % of a wind, or the paper's."""
        weather, scenario = self.scenario.weather, self.scenario
        if weather.wind_speed_mps is None:
            reach = weather.drift_node_per_step
            ranges = weather.drift_ranges_node_per_step or ((-reach, reach), (-reach, reach))
            row, col = (drawn(self.key, Stream.WEATHER, axis, 0) for axis in (0, 1))
            (low, high), (left, right) = ranges
            return low + row * (high - low), left + col * (right - left)
        nodes = 0.03 * weather.wind_speed_mps * scenario.period_s / scenario.map.pitch_m
        if weather.wind_from_deg is None:
            toward = 2.0 * math.pi * drawn(self.key, Stream.WEATHER, 0, 1000)
            return -nodes * math.sin(toward), nodes * math.cos(toward)
        bearing = math.radians(weather.wind_from_deg)
        return nodes * math.cos(bearing), -nodes * math.sin(bearing)  # from the north: southward

    @property
    def over(self) -> bool:
        """Whether the episode has ended."""
        return self.step >= self.scenario.horizon or not self.items

    def order(self) -> list[int]:
        """Agents as they choose: teams that collect first, in a team the highest number."""
        team, first = self.scenario.team, list(self.scenario.rules.order)
        names = first or sorted(team, key=lambda name: (not team[name].collects, name))
        numbers = range(len(self.agents))
        return sorted(numbers, key=lambda a: (names.index(self.agents[a].team), -a))

    def legal(self, agent: Agent, chosen: set[int]) -> dict[int, tuple[int, int]]:
        """Direction -> (node, steps) of the moves that an agent can make."""
        rules, options = self.scenario.rules, {}
        for d in range(8):
            way = [agent.node]
            for _ in range(agent.role.nodes):
                following = self.water.beside(way[-1], d)
                if following < 0 or following in chosen:
                    break
                way.append(following)
            steps = len(way) - 1
            if rules.jump:
                way, steps = [self.water.jumped(agent.node, d, agent.role.nodes)], agent.role.nodes
            free = way[-1] >= 0 and way[-1] not in chosen
            whole = steps == agent.role.nodes or (rules.shorten and steps > 0)
            if free and whole and length_of(d, steps) <= agent.energy_left + 1e-9:
                options[d] = (way[-1], steps)
        if rules.stay and agent.node not in chosen:
            options[STAY] = (agent.node, 0)
        return options

    def final(self, number: int, wanted: NDArray[np.float64]) -> tuple[int, int, int] | None:
        """Direction, node (-1: none) and steps of a move that is made whoever is there, if any."""
        agent, steps = self.agents[number], self.agents[number].role.nodes
        for d in range(8) if self.scenario.rules.jump else ():
            if wanted[d] >= FINAL and length_of(d, steps) <= agent.energy_left + 1e-9:
                return d, self.water.jumped(agent.node, d, steps), steps
        return None

    def hit(self, number: int) -> bool:
        """Whether an agent's own move does not count in this step."""
        choice = self.scenario.corruption
        who = -1 if choice.whole_team else number
        hit = drawn(self.key, Stream.CORRUPTION, who, self.step) < choice.epsilon
        return hit and self.agents[number].team == choice.team

    def corrupted(self, number: int, options: dict[int, tuple[int, int]]) -> int | None:
        """The move that takes the place of an agent's own; None if it keeps that."""
        choice, agent = self.scenario.corruption, self.agents[number]
        if not options or not self.hit(number):
            return None
        open_to, belief = list(options), self.mind_of(number).belief()
        if choice.whole_team and agent.role.collects:
            known = [d for d in open_to if d != STAY and belief.get(options[d][0], 0) > 0]
            open_to = known or open_to
        draw = drawn(self.key, Stream.CORRUPTION, len(self.agents) + number, self.step)
        self.sensors.met["random action"] += 1
        return open_to[int(draw * len(open_to))]

    def mind_of(self, number: int) -> Mind:
        """By what an agent acts."""
        return self.minds[number if self.link else 0]

    def move(self, preferences: NDArray[np.float64]) -> None:
        """Let agents choose one after the other; nobody enters a node that is taken."""
        chosen, ways = set[int](), {}
        for number in self.order():
            agent = self.agents[number]
            options = self.legal(agent, chosen)
            best, final = self.corrupted(number, options), self.final(number, preferences[number])
            if best is None and options:
                best = max(options, key=lambda d, n=number: preferences[n, d])  # type: ignore[misc]
            ways[number] = (STAY, -1, 0) if best is None else (best, *options[best])
            if final and not self.hit(number):
                ways[number] = final
            direction, end, steps = ways[number]
            agent.blocked = end < 0
            ways[number] = direction, agent.node if agent.blocked else end, steps
            self.sensors.met["blocked"] += agent.blocked
            self.sensors.met["final and blocked"] += agent.blocked and steps > 0
            self.sensors.met["shared"] += ways[number][1] in chosen
            chosen.add(ways[number][1])
        for number, (direction, node, steps) in ways.items():
            agent = self.agents[number]
            agent.direction, agent.node, agent.steps = direction, node, steps
            agent.way += length_of(direction, steps)
            if direction < STAY:
                down, right = COMPASS[direction]
                agent.yaw = math.atan2(-down, right)

    def collect(self) -> None:
        """Agents that collect take what is in their node, while they have room."""
        for number, agent in enumerate(self.agents):
            agent.took = False
            self.sensors.met["full"] += agent.room_left == 0
            self.sensors.met["out of energy"] += agent.energy_left < 1.0
            for k in sorted(self.items) if agent.role.collects else ():
                if self.water.node_of(self.items[k]) == agent.node and agent.room_left > 0:
                    del self.items[k]
                    agent.taken, agent.took = agent.taken + 1, True
                    self.taken[k] = (self.step, number)
                    self.found.setdefault(k, (self.step, number))

    def drift_items(self) -> None:
        """Items drift by the constant vector and their own noise."""
        stream = np.uint64(stream_key(np.uint64(self.key), Stream.NOISE))
        strength, walls = self.scenario.weather.noise_node_per_step, self.scenario.rules.walls
        for k, (row, col) in self.items.items():
            noise = item_noise(stream, k, self.step)
            place = (
                row + (self.drift[0] + strength * noise[0]),
                col + (self.drift[1] + strength * noise[1]),
            )
            self.items[k] = self.water.pushed_into_water(place, walls)

    def truth(self) -> NDArray[np.int64]:
        """(node,) items."""
        counts = np.zeros(len(self.water.cells), np.int64)
        np.add.at(counts, [self.water.node_of(place) for place in self.items.values()], 1)
        return counts

    def in_view(self, number: int) -> list[int]:
        """Nodes that an agent sees now."""
        agent = self.agents[number]
        return self.sensors.in_view(agent.node, agent.role.radius, agent.yaw)

    def _seen_by(self, number: int, where: dict[int, int]) -> dict[int, int]:
        """Node -> items that an agent sees; items not seen by anybody before are found."""
        agent, sensors = self.agents[number], self.scenario.sensors
        counts = dict.fromkeys(self.in_view(number), 0)
        for k, node in where.items():
            if node not in counts:
                continue
            away = self.water.apart(agent.node, node)
            if self.sensors.detects(k, away, self.step, counts[node] > 0):
                counts[node] += 1
                self.found.setdefault(k, (self.step, number))
        manned = {other.node for other in self.agents if other.role.collects}
        for node in counts if sensors.false_rate else ():
            counts[node] += node not in manned and self.sensors.false_positive(node, self.step)
        return counts

    def _look(self) -> None:
        """All scan, those that do not collect first; then scans are passed on."""
        where = {k: self.water.node_of(place) for k, place in sorted(self.items.items())}
        self.item_nodes.append(where)
        numbers = range(len(self.agents))
        for number in sorted(numbers, key=lambda a: (self.agents[a].role.collects, a)):
            agent = self.agents[number]
            self.scans[number, self.step] = scan = Scan(
                step=self.step,
                agent=number,
                node=agent.node,
                counts=self._seen_by(number, where),
                energy_left=agent.energy_left,
                room_left=agent.room_left,
                taken=agent.taken,
                took=agent.took,
                yaw=agent.yaw,
            )
            self.pooled.receive(scan)
        if self.link:
            self._pass_on(self.link)

    def _pass_on(self, link: SlowLink) -> None:
        at = [agent.node for agent in self.agents]
        link.exchange(self.scans, at, self.water, self.step)
        self.delayed = [[] for _ in self.minds]
        for (owner, a, s), when in sorted(link.received.items(), key=lambda one: one[0][::-1]):
            if when == self.step:
                self.minds[owner].receive(self.scans[a, s])
                if s < self.step:
                    self.delayed[owner].append(self.scans[a, s])
                    self.sensors.met["received late"] += 1

    def advance(self, preferences: NDArray[np.float64]) -> None:
        """One step: move, collect, drift, scan."""
        self.step += 1
        self.move(preferences)
        self.collect()
        self.drift_items()
        self._look()

    def idleness(self) -> NDArray[np.float64]:
        """(node,) 1 before the first scan, then 0 and growing by 1 / (0.9 T)."""
        growth = 1.0 / (0.9 * self.scenario.horizon)
        seen = self.pooled.seen
        unseen_for = [self.step - seen[n] if n in seen else math.inf for n in self._nodes]
        return np.minimum(1.0, growth * np.array(unseen_for))

    @property
    def _nodes(self) -> range:
        return range(len(self.water.cells))

    def map_of(self, belief: dict[int, int]) -> NDArray[np.int64]:
        """(node,) items believed."""
        return np.array([belief.get(node, 0) for node in self._nodes])

    def rmse(self, one: NDArray[np.int64], other: NDArray[np.int64]) -> tuple[float, float]:
        """Error between two maps, over the nodes and per column."""
        grid = np.zeros((2, self.water.height, self.water.width))
        rows, cols = zip(*self.water.cells, strict=True)
        grid[0, rows, cols], grid[1, rows, cols] = one, other
        squared = (gaussian_filter(grid[0], 1.0) - gaussian_filter(grid[1], 1.0)) ** 2
        nodes = float(np.sqrt(squared[rows, cols].mean()))
        return nodes, float(np.sqrt(squared.mean(axis=0)).mean())

    def overlap(self, collects: bool) -> float:
        """Nodes that two of a kind see, of those that one sees."""
        numbers = [n for n, agent in enumerate(self.agents) if agent.role.collects == collects]
        seen = [node for number in numbers for node in self.in_view(number)]
        twice = {node for node in seen if seen.count(node) >= 2}
        return len(twice) / len(set(seen)) if seen else math.nan
