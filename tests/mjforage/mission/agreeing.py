"""Comparison of a mission with the one in plain Python: state and scores."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from mjforage.mission.mission import Mission
from mjforage.mission.moves import FINAL
from mjforage.mission.scoring import Scorer
from mjforage.mission.task import NEVER, Observation
from mjforage.scenario.roles import UNLIMITED
from tests.mjforage.mission.slow_link import SlowLink
from tests.mjforage.mission.slow_minds import Mind, Scan
from tests.mjforage.mission.slow_mission import SlowMission


def play(
    mission: Mission, slow: list[SlowMission], seed: int, see: Callable[[Mission], None]
) -> None:
    """Play both with the same random preferences, and compare them after every step.

    Where moves jump, some of the preferences are final.
    """
    rng, jump = np.random.default_rng(seed), mission.setup.scenario.rules.jump
    agree(mission, slow)
    see(mission)
    while mission.active.any():
        preferences = rng.random((len(slow), len(mission.setup.fleet), 9))
        preferences[rng.random(preferences.shape) < (0.05 if jump else 0.0)] = FINAL
        active = mission.active.copy()
        mission.advance(preferences)
        for e in np.flatnonzero(active).tolist():
            slow[e].advance(preferences[e])
        agree(mission, slow)
        see(mission)


def agree(mission: Mission, slow: list[SlowMission]) -> None:
    """Compare all that there is."""
    owned, pooled = mission.owner_observation, mission.observation
    for e, oracle in enumerate(slow):
        assert mission.active[e] == (not oracle.over)
        assert mission.step[e] == oracle.step
        _agents(mission, e, oracle)
        _items(mission, e, oracle)
        _mind(pooled, e, oracle, oracle.pooled)
        np.testing.assert_allclose(
            mission.idleness(np.array([e]))[0], oracle.idleness(), atol=1e-12
        )
        for owner, mind in enumerate(oracle.minds):
            row = e * len(oracle.minds) + owner
            _mind(owned, row, oracle, mind)
            assert owned.owner[row] == (owner if len(oracle.minds) > 1 else -1)
            if oracle.link and mission.active[e]:
                _late(mission, owned, row, oracle.delayed[owner])


def _agents(mission: Mission, e: int, oracle: SlowMission) -> None:
    state, moves = mission.state, mission.moves
    for a, agent in enumerate(oracle.agents):
        assert state.agent_node[e, a] == agent.node
        assert tuple(state.agent_rc[e, a]) == oracle.water.cells[agent.node]
        assert state.agent_yaw[e, a] == pytest.approx(agent.yaw)
        assert state.distance[e, a] == pytest.approx(agent.way)
        assert state.energy[e, a] == pytest.approx(agent.way)
        if moves is not None and oracle.step and mission.active[e]:
            assert moves.direction[e, a] == agent.direction
            assert moves.target[e, a] == agent.node
            assert moves.steps[e, a] == agent.steps
            assert moves.blocked[e, a] == agent.blocked
            assert state.outcome[e, a] == 2 * agent.blocked


def _items(mission: Mission, e: int, oracle: SlowMission) -> None:
    state, entries = mission.state, mission.ledger
    present = np.flatnonzero(state.item_node[e] >= 0).tolist()
    assert present == sorted(oracle.items)
    for k in present:
        assert state.item_rc[e, k] == pytest.approx(oracle.items[k], abs=1e-12)
        assert state.item_node[e, k] == oracle.item_nodes[-1][k]
    np.testing.assert_array_equal(entries.truth[e], oracle.truth())
    assert mission.initial.n_items[e] == oracle.total
    assert mission.truth.drift_rc[e] == pytest.approx(oracle.drift, abs=1e-12)
    assert mission.node_drift_rc[e, -1] == pytest.approx(oracle.drift, abs=1e-12)
    for k in range(oracle.total):
        found = (int(entries.t_discovered[e, k]), int(entries.discovered_by[e, k]))
        taken = (int(entries.t_collected[e, k]), int(entries.collected_by[e, k]))
        assert found == oracle.found.get(k, (-1, -1))
        assert taken == oracle.taken.get(k, (-1, -1))
        assert state.collected_by[e, k] == taken[1]


def _mind(seen: Observation, row: int, oracle: SlowMission, mind: Mind) -> None:
    belief = oracle.map_of(mind.belief())
    np.testing.assert_array_equal(seen.belief[row], belief)
    known = seen.known[row, : seen.n_known[row]]
    assert sorted(known.tolist()) == np.flatnonzero(belief).tolist()
    seen_at = mind.seen
    last = [seen_at.get(node, NEVER) for node in range(belief.size)]
    assert seen.last_seen[row].tolist() == last
    for a, agent in enumerate(oracle.agents):
        scan = mind.of.get(a, oracle.scans[a, 0])
        received = a in mind.of
        assert seen.agent_seen[row, a] == (scan.step if received else 0)
        assert seen.agent_node[row, a] == scan.node
        assert seen.energy_left[row, a] == pytest.approx(scan.energy_left)
        room = UNLIMITED if math.isinf(scan.room_left) else scan.room_left
        assert seen.room_left[row, a] == room, agent
        assert seen.taken[row, a] == scan.taken
        assert seen.pickup[row, a] == scan.took
        assert seen.agent_yaw[row, a] == pytest.approx(scan.yaw)


def _late(mission: Mission, owned: Observation, row: int, delayed: list[Scan]) -> None:
    listed = owned.delayed_scans[row]
    listed_scans = [tuple(scan) for scan in listed.tolist() if scan[0] >= 0]
    assert listed_scans == [(scan.step, scan.agent, scan.node) for scan in delayed]
    for i, scan in enumerate(delayed):
        radius = int(mission.task.radius_number[scan.agent])
        nodes = mission.task.views.of(scan.node, radius).tolist()
        shown = zip(nodes, owned.delayed_shown[row, i].tolist(), strict=False)
        assert {node: items for node, items in shown if items >= 0} == scan.counts


class SlowScores:
    """Courses and numbers of the metrics of one episode, from the states as they were."""

    def __init__(self, oracle: SlowMission) -> None:
        self.oracle, self.series = oracle, dict[str, list[float]]()
        self.tracks: list[list[tuple[float, ...]]] = []  # step, agent
        self.see()

    def see(self) -> None:
        """Take the series and the tracks now."""
        each = self.oracle.agents
        self.tracks.append(
            [(a.node, a.yaw, a.way, a.took, 2 * a.blocked, a.direction) for a in each]
        )
        for key, value in self._now().items():
            self.series.setdefault(key, []).append(value)

    def _now(self) -> dict[str, float]:
        oracle, horizon = self.oracle, self.oracle.scenario.horizon
        truth, pooled = oracle.truth(), oracle.map_of(oracle.pooled.belief())
        ages = [
            np.mean(
                [oracle.step - seen_at[n] if n in seen_at else horizon for n in range(truth.size)]
            )
            for seen_at in (mind.seen for mind in oracle.minds)
        ]
        now = {
            "rmse": oracle.rmse(truth, pooled)[0],
            "rmse_columns": oracle.rmse(truth, pooled)[1],
            "mi": float(oracle.idleness().mean()),
            "co_scouts": oracle.overlap(False),
            "co_foragers": oracle.overlap(True),
            "aoi": float(np.mean(ages)),
            "pta_d": 100.0 * len(oracle.found) / oracle.total,
            "pta_c": 100.0 * len(oracle.taken) / oracle.total,
            "csr": self._cooperative(),
            "gini_scouts": self._gini(False),
            "gini_foragers": self._gini(True),
        }
        return now | (self._linked(oracle.link, truth) if oracle.link else {})

    def _linked(
        self, link: SlowLink, truth: np.ndarray[tuple[int], np.dtype[np.int64]]
    ) -> dict[str, float]:
        oracle, n = self.oracle, len(self.oracle.agents)
        maps = [oracle.map_of(mind.belief()) for mind in oracle.minds]
        pairs = [(i, j) for i in range(n) for j in range(n) if i != j]
        if not pairs:
            return {}
        seen = [oracle.minds[i].of[j].step if j in oracle.minds[i].of else 0 for i, j in pairs]
        return {
            "contact": float(np.mean([link.snr[pair] >= 0.0 for pair in pairs])),
            "position_age": float(np.mean([oracle.step - step for step in seen])),
            "disagreement": float(np.mean([oracle.rmse(maps[i], maps[j])[0] for i, j in pairs])),
            "rmse_holders": float(np.mean([oracle.rmse(truth, one)[0] for one in maps])),
        }

    def _cooperative(self) -> float:
        agents, found = self.oracle.agents, self.oracle.found
        by_scouts = [not agents[found[k][1]].role.collects for k in self.oracle.taken]
        return float(np.mean(by_scouts)) if by_scouts else math.nan

    def _gini(self, collects: bool) -> float:
        events = self.oracle.taken if collects else self.oracle.found
        by = [agent for _, agent in events.values()]
        agents = enumerate(self.oracle.agents)
        shares = [by.count(n) for n, agent in agents if agent.role.collects == collects]
        if not sum(shares):
            return math.nan
        return sum(abs(a - b) for a in shares for b in shares) / (2 * len(shares) * sum(shares))

    def numbers(self) -> dict[str, float]:
        """Key -> metric of the whole episode; series go on with their last values."""
        oracle, horizon = self.oracle, self.oracle.scenario.horizon
        padded = {
            key: series + [series[-1]] * (horizon + 1 - len(series))
            for key, series in self.series.items()
        }
        way = sum(agent.way for agent in oracle.agents)
        kinds = [agent.role.collects for agent in oracle.agents]
        waits = [
            (oracle.taken[k][0] - t) / horizon
            for k, (t, by) in oracle.found.items()
            if k in oracle.taken and not kinds[by]
        ]
        found = {
            "length": oracle.step,
            "cleared": float(not oracle.items),
            "energy_per_item": way / len(oracle.taken) if oracle.taken else math.nan,
            "throughput": _per(len(oracle.taken), kinds.count(True) * horizon),
            "throughput_scouts": _per(len(oracle.found), kinds.count(False) * horizon),
            "nt50": self._time_to(50.0),
            "nt90": self._time_to(90.0),
            "dsl": float(np.mean(waits)) if waits else math.nan,
            "irr_mean": (padded["mi"][0] - padded["mi"][-1]) / horizon,
            "mi_mean": float(np.mean(padded["mi"])),
            "rmse_holders": padded.get("rmse_holders", [math.nan])[-1],
        }
        for key in ("co_scouts", "co_foragers", "aoi", "contact", "position_age", "disagreement"):
            found[key] = float(np.mean(padded.get(key, [math.nan])))
        return found | self._traffic()

    def _time_to(self, share: float) -> float:
        horizon = self.oracle.scenario.horizon
        reached = [t for t, pta in enumerate(self.series["pta_c"]) if pta >= share]
        return reached[0] / horizon if reached else 1.0

    def _traffic(self) -> dict[str, float]:
        link, now = self.oracle.link, self.oracle.step
        if not link:
            keys = ("delivered", "lost", "dropped", "bytes_sent", "handover")
            return dict.fromkeys(keys, math.nan)
        return {
            "delivered": sum(when <= now for when in link.copies),
            "lost": link.lost,
            "dropped": link.dropped,
            "bytes_sent": link.bytes,
            "handover": self._handover(link),
        }

    def _handover(self, link: SlowLink) -> float:
        """Mean time from discovery until a collector knows, of T."""
        oracle, horizon, waits = self.oracle, self.oracle.scenario.horizon, []
        for k, (t, _) in oracle.found.items():
            known = [
                when
                for (h, a, s), when in link.received.items()
                if s >= t
                and when <= oracle.step
                and oracle.agents[h].role.collects
                and oracle.scans[a, s].counts.get(oracle.item_nodes[s].get(k, -1), 0) > 0
            ]
            known += [oracle.taken[k][0]] if k in oracle.taken else []
            waits.append((min(known, default=horizon) - t) / horizon)
        return float(np.mean(waits)) if waits else math.nan


def _per(count: int, over: int) -> float:
    return count / over if over else math.nan


def score_alike(scorer: Scorer, slow: list[SlowScores]) -> None:
    """Compare the metrics of a batch that is over."""
    scores, log = scorer.scores(), scorer.log
    for e, oracle in enumerate(slow):
        names = ("agent_node", "yaw", "distance", "pickup", "outcome", "direction")
        logged = np.stack([getattr(log, name)[e, : log.length[e] + 1] for name in names], axis=-1)
        np.testing.assert_allclose(logged, oracle.tracks, rtol=1e-5, atol=1e-6)
        for key, series in oracle.series.items():
            taken = scores.series[key][e]
            expected = series + [series[-1]] * (taken.size - len(series))
            np.testing.assert_allclose(taken, expected, rtol=1e-5, atol=1e-7, err_msg=key)
        for key, value in oracle.numbers().items():
            one = scores.scalars[key][e]
            np.testing.assert_allclose(one, value, rtol=1e-5, atol=1e-7, err_msg=key)
