"""Reception of scans in plain Python: contacts, bad times, noise, budgets, latency."""

import math

import numpy as np

from mjforage.base.randomness import Stream, normal, stream_key
from mjforage.scenario.link import Link
from tests.mjforage.mission.slow_map import SlowMap
from tests.mjforage.mission.slow_minds import Scan, drawn


class SlowLink:
    """The links of one episode.

    Attributes
    ----------
    received : (owner, agent, step) -> step at which the owner receives that scan
    """

    def __init__(
        self, link: Link, pitch_m: float, horizon: int, relays: list[bool], key: int
    ) -> None:
        self.link, self.pitch_m, self.steps, self.key = link, pitch_m, horizon + 1, key
        self.relays = [one or link.relay for one in relays]
        self.received: dict[tuple[int, int, int], int] = {}
        self.bad: set[tuple[int, int]] = set()
        self.copies: list[int] = []  # when each arrives, whoever has sent it too
        self.lost = self.dropped = self.bytes = 0

    def signal(self, water: SlowMap, at: list[int], i: int, j: int, step: int) -> float:
        """Signal to noise [dB]; below 0 there is no contact."""
        link, n = self.link, len(at)
        far = self.pitch_m * water.apart(at[i], at[j])
        walls = water.walls(at[i], at[j]) if link.wall_db else 0
        if link.model == "disk":
            return math.inf if far <= link.range_m and not walls else -math.inf
        if link.model == "none":
            return -math.inf
        shadow = 0.0
        if link.shadowing_db:
            stream = np.uint64(stream_key(np.uint64(self.key), Stream.SHADOWING))
            shadow = link.shadowing_db * normal(stream, min(i, j) * n + max(i, j), step)
        path = link.l0_db + 10.0 * link.exponent * math.log10(max(far, 1.0))
        return link.tx_dbm - link.floor_dbm - path - walls * link.wall_db + shadow

    def pass_time(self, agents: int, step: int) -> None:
        """Let every directed link turn bad or good (Gilbert and Elliott)."""
        loss, burst = self.link.loss, self.link.burst
        to_good = 1.0 - loss if burst == 1.0 else 1.0 / burst
        to_bad = loss if burst == 1.0 else loss / (burst * (1.0 - loss))
        for i in range(agents):
            for j in range(agents):
                draw, was = drawn(self.key, Stream.LOSS, i * agents + j, step), (i, j) in self.bad
                bad = draw < loss if step == 0 else draw >= to_good if was else draw < to_bad
                (self.bad.add if bad else self.bad.discard)((i, j))

    def garbled(self, n: int, i: int, j: int, scan: Scan, size: int, snr: float, now: int) -> bool:
        """Whether noise spoils a packet of QPSK."""
        if snr == math.inf:
            return False
        bit = 0.5 * math.erfc(math.sqrt(10.0 ** (snr / 10.0)))
        index = ((i * n + j) * n + scan.agent) * self.steps + scan.step
        return drawn(self.key, Stream.PACKETS, index, now) < 1.0 - (1.0 - bit) ** (8 * size)

    def exchange(
        self, scans: dict[tuple[int, int], Scan], at: list[int], water: SlowMap, now: int
    ) -> None:
        """All send what others in contact lack, the newest first, and receive it `latency` later.

        Parameters
        ----------
        scans : (agent, step) -> all scans that were ever made
        """
        n = len(at)
        self.snr = {
            (i, j): self.signal(water, at, i, j, now) for i in range(n) for j in range(n) if i != j
        }
        self.pass_time(n, now)
        for a in range(n):
            self.received[a, a, now] = now
        before, arriving = dict(self.received), set[tuple[int, int, int]]()
        for i in range(n):
            budget, cells = self.link.bytes or math.inf, self.link.cells or math.inf
            for (a, s), scan in sorted(scans.items(), key=lambda each: (-each[0][1], each[0][0])):
                mine = before.get((i, a, s), now + 1) <= now and (a == i or self.relays[i])
                lacking = [
                    j
                    for j in range(n)
                    if j != i and self.snr[i, j] >= 0.0 and (j, a, s) not in before
                ]
                if not mine or not lacking:
                    continue
                full = sum(items > 0 for items in scan.counts.values())
                if 6 + 3 * full > budget or 1 + full > cells:
                    self.dropped += 1
                    continue
                budget, cells = budget - 6 - 3 * full, cells - 1 - full
                self.bytes += 6 + 3 * full
                for j in lacking:
                    about = scan, 6 + 3 * full, self.snr[i, j], now
                    if (i, j) in self.bad or self.garbled(n, i, j, *about):
                        self.lost += 1
                    else:
                        arriving.add((j, a, s))
                        self.copies.append(now + self.link.latency)
        for each in arriving:
            self.received[each] = now + self.link.latency
