"""Scans and what is made of them, in plain Python: imperfect sensors, maps, filtered maps.

Draws are of the streams of `mjforage.base.randomness`; what they decide is worked out here.
"""

import math
from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from scipy.stats import beta

from mjforage.base.randomness import Stream, stream_key, uniform
from mjforage.scenario.scenario import Scenario
from tests.mjforage.mission.slow_map import SlowMap


def drawn(key: int, stream: Stream, index: int, step: int) -> float:
    """Uniform number of an episode's stream."""
    return float(uniform(np.uint64(stream_key(np.uint64(key), stream)), index, step))


@dataclass(frozen=True)
class Scan:
    """Scan of an agent at the end of a step, with what it says of itself."""

    step: int
    agent: int
    node: int
    counts: dict[int, int]  # node -> items, of the nodes that it sees
    energy_left: float
    room_left: float
    taken: int
    took: bool
    yaw: float


class SensorConfig:
    """Sensors of one episode."""

    def __init__(self, scenario: Scenario, water: SlowMap, key: int) -> None:
        self.sensors, self.water, self.key = scenario.sensors, water, key
        self.met = Counter[str]()  # how often something has happened

    def chance(self, distance: float) -> float:
        """Chance to detect a mean item."""
        sensors = self.sensors
        if sensors.detection_table:
            at, chances = np.array(sensors.detection_table).T
            return float(np.interp(distance, at, chances))
        if sensors.half_range_node == 0.0:
            return sensors.detection
        return sensors.detection / (
            1.0 + math.exp((distance - sensors.half_range_node) / sensors.slope_node)
        )

    def hardness(self, item: int) -> float:
        """An item's chance over the mean one: a beta variate of correlation `persistence`."""
        mean, together = self.chance(0.0), self.sensors.persistence
        if self.sensors.half_range_node and not self.sensors.detection_table:
            mean = self.sensors.detection
        if not together or not 0.0 < mean < 1.0:
            return 1.0
        total = 1.0 / together - 1.0
        draw = drawn(self.key, Stream.PERSISTENCE, item, 0)
        return float(beta.ppf(draw, mean * total, (1.0 - mean) * total) / mean)

    def in_view(self, node: int, radius: float, yaw: float) -> list[int]:
        """Nodes in the field of view, the own one included."""
        row, col = self.water.cells[node]
        seen = []
        for other in self.water.seen_from(node, radius):
            to_row, to_col = self.water.cells[other]
            off = math.atan2(row - to_row, to_col - col) - yaw
            off = abs(math.remainder(off, 2.0 * math.pi))
            ahead = off <= math.radians(self.sensors.fov_deg) / 2.0 + 1e-9
            self.met["out of the field of view"] += not ahead
            if other == node or ahead:
                seen.append(other)
        return seen

    def detects(self, item: int, distance: float, step: int, another: bool) -> bool:
        """Whether an item is seen, beside `another` that was or alone."""
        if self.sensors.perfect:
            return True
        chance = self.chance(distance) * self.hardness(item)
        if drawn(self.key, Stream.DETECTION, item, step) >= chance:
            self.met["missed"] += 1
            return False
        merged = another and drawn(self.key, Stream.MERGING, item, step) < self.sensors.merge
        self.met["overlooked beside another"] += merged
        return not merged

    def false_positive(self, node: int, step: int) -> bool:
        """Whether an item is seen in a node that is none."""
        epoch = step // self.sensors.false_hold
        there = drawn(self.key, Stream.FALSE_POSITIVES, node, epoch) < self.sensors.false_rate
        self.met["invented"] += there
        return there


@dataclass
class Mind:
    """One who has received scans."""

    scenario: Scenario
    sensors: SensorConfig
    scans: list[Scan] = field(default_factory=list)
    newest: dict[int, tuple[int, int]] = field(default_factory=dict)  # node -> (step, items)
    of: dict[int, Scan] = field(default_factory=dict)  # agent -> its newest scan

    def receive(self, scan: Scan) -> None:
        """Remember a scan."""
        self.scans.append(scan)
        for node, items in scan.counts.items():
            self.newest[node] = max(self.newest.get(node, (-1, -1)), (scan.step, items))
        if scan.agent not in self.of or scan.step >= self.of[scan.agent].step:
            self.of[scan.agent] = scan

    @property
    def seen(self) -> dict[int, int]:
        """Node -> newest step at which it was seen; the start's may not count."""
        first = 0 if self.scenario.rules.start_seen else 1
        return {node: step for node, (step, _) in self.newest.items() if step >= first}

    def belief(self) -> dict[int, int]:
        """Items believed in every node that was seen."""
        sensors = self.scenario.sensors
        if sensors.map == "last" or sensors.perfect:
            return {node: items for node, (_, items) in self.newest.items()}
        return {node: math.floor(items + 0.5) for node, items in self._expected().items()}

    def _expected(self) -> dict[int, float]:
        """Items expected, from all scans since the start: those of one step count once."""
        water, false = self.sensors.water, self.scenario.sensors.false_rate
        counts: dict[tuple[int, int], int] = {}
        chances: dict[tuple[int, int], float] = {}
        for scan in self.scans:
            for node, items in scan.counts.items():
                at = scan.step, node
                chance = self.sensors.chance(water.apart(scan.node, node))
                counts[at] = max(counts.get(at, 0), items)
                chances[at] = max(chances.get(at, 0.0), chance)
        expected: dict[int, float] = {}
        for (step, node), seen in sorted(counts.items()):
            before = expected.get(node, self.scenario.items.mean / len(water.cells))
            p = chances[step, node]
            real = p * before / (p * before + false) if p * before + false > 0.0 else 1.0
            expected[node] = (1.0 - p) * before + seen * real
        return expected
