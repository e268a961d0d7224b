"""The link in missions: what is received when, by whom, and that nothing else is known."""

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.exchange import Ideal
from mjforage.mission.link.propagation import two_ray_loss_db
from mjforage.mission.mission import Mission
from mjforage.mission.task import Observation, Task
from tests.mjforage.mission.link.nets import DISK, advanced, setup_of, started


def test_by_default_there_is_no_link() -> None:
    mission = Mission(setup_of())
    assert isinstance(mission.exchange, Ideal)
    assert mission.exchange.link_log is None


def test_a_disk_ends_at_its_range_and_at_walls() -> None:
    """Agents that start in the port's bays: 16 m, with and without the quays between them."""
    for wall, range_m, received in ((0, 1e6, 12), (0, 9.0, 6), (1, 1e6, 6), (0, 1.0, 0)):
        keys = (DISK, f"link.range_m={range_m}", f"link.wall_db={wall}")
        mission, radio = started(setup_of(*keys), 1)
        at = mission.state.agent_node[0]
        rows, cols = mission.setup.graph.rows[at], mission.setup.graph.cols[at]
        assert sorted(rows) == [10, 12, 14, 16] and (cols == 7).all()
        contacts = (radio.net.contacts.snr_db >= 0.0).sum()
        near = sum(
            1
            for i in range(4)
            for j in range(4)
            if i != j and 4.0 * abs(rows[i] - rows[j]) <= range_m
        )
        if wall:
            land = mission.setup.graph.node_of_cell[:, 7] < 0
            near = sum(
                1
                for i in range(4)
                for j in range(4)
                if i != j and not land[min(rows[i], rows[j]) : max(rows[i], rows[j])].any()
            )
        assert contacts == near, received


def test_a_link_is_of_the_antennas_of_its_two_ends() -> None:
    """Scouts' at 0.5 m, foragers' at 3 m: two rays over the ways between them."""
    heights = ("team.scouts.antenna_m=0.5", "team.foragers.antenna_m=3", "items.mean=5")
    mission, radio = started(setup_of('link.model="two-ray"', *heights), 1)
    at, graph, link = mission.state.agent_node[0], mission.setup.graph, mission.setup.scenario.link
    antenna = np.where(mission.setup.fleet.collects, 3.0, 0.5)
    for i in range(4):
        for j in range(i):
            rows, cols = (np.ptp(each[at[[i, j]]]) for each in (graph.rows, graph.cols))
            d = 4.0 * float(np.hypot(rows, cols))
            loss = two_ray_loss_db(d, antenna[i], antenna[j], link.frequency_hz)
            expected = link.tx_dbm - link.floor_dbm - loss
            assert radio.net.contacts.snr_db[0, i, j] == pytest.approx(expected)
            assert radio.net.contacts.snr_db[0, j, i] == pytest.approx(expected)


def test_what_is_lost_in_decisions_adds_up_to_all_that_is_lost() -> None:
    mission, radio = started(setup_of(DISK, "link.range_m=80", "link.loss=0.5"), 2)
    policy, lost = create_policy("random"), radio.link_log.lost_now.sum(axis=(1, 2))
    mission.prepare(policy)
    for _ in range(8):
        mission.advance(mission.ask(policy))
        lost = lost + radio.link_log.lost_now.sum(axis=(1, 2))
    np.testing.assert_array_equal(lost, radio.link_log.lost)
    assert (lost > 10).all()


def test_a_filtered_map_is_of_all_scans_that_its_owner_has_received_each_once() -> None:
    """Of the prior and, step by step, of the best chance and largest count; delayed ones too."""
    sensors = ("sensors.detection=0.6", "sensors.half_range_node=6", "sensors.false_rate=0.01")
    link = (DISK, "link.range_m=60", "link.loss=0.3", "link.latency=2")
    mission, radio = started(setup_of(*link, *sensors, "sensors.map=filtered"), 2)
    advanced(mission, "greedy", 14)
    net, graph, delayed = radio.net, mission.setup.graph, 0
    for row in range(8):
        e, h = divmod(row, 4)
        expected = np.full(len(graph), 75.0 / len(graph))
        for s in range(15):
            chance, count = np.zeros(len(graph)), np.full(len(graph), -1)
            for a in np.flatnonzero(net.inbox.received_at[e, h, :, s] >= 0):
                if net.inbox.received_at[e, h, a, s] > 14:
                    continue
                delayed += net.inbox.received_at[e, h, a, s] > s
                at = int(net.log.node[e, s, a])
                view = net.views.of(at, int(net.radius_number[a]))
                far = np.hypot(graph.rows[view] - graph.rows[at], graph.cols[view] - graph.cols[at])
                chance[view] = np.maximum(chance[view], 0.6 / (1.0 + np.exp(far - 6.0)))
                count[view] = np.maximum(count[view], net.log.shown[e, s, a, : view.size])
            real = chance * expected / (chance * expected + 0.01)
            after = (1.0 - chance) * expected + count * real
            expected = np.where(count >= 0, after, expected)
        np.testing.assert_allclose(net.filtered.density[row], expected, rtol=1e-9)
        seen = radio.knowledge.last_seen[row] >= 0
        believed = np.where(seen, np.floor(expected + 0.5), 0.0)
        np.testing.assert_array_equal(radio.knowledge.belief[row], believed)
    assert delayed > 100


def test_every_agent_acts_by_its_own_row_and_delayed_padding_says_nothing() -> None:
    """Each wants to go another way in the row of each owner; only its own counts."""
    mission, radio = started(setup_of(DISK, "link.range_m=9", "link.latency=1"), 6)

    class OwnWay:
        def reset(self, task: Task, keys: UInt64Array) -> None:
            pass

        def act(self, observation: Observation) -> NDArray[np.float64]:
            shape = (*observation.agent_node.shape, 9)
            answer = np.zeros(shape)
            answer[np.arange(shape[0]), :, observation.owner] = 1.0
            return answer

    advanced(mission, "random", 8)
    policy = OwnWay()
    mission.prepare(policy)
    answer = mission.ask(policy)
    assert (answer.argmax(axis=-1) == np.arange(4)).all()
    delayed = radio.delayed
    padded = delayed.step < 0
    assert padded.any() and not padded.all()
    assert (delayed.scans[padded] == -1).all() and (delayed.shown[padded] == 0).all()


def test_the_belief_planner_loses_nothing_by_a_latency() -> None:
    mission = Mission(setup_of("horizon=150", DISK, "link.latency=1"))
    mission.reset(7, np.arange(3))
    mission.run(create_policy("belief"))
    assert mission.taken.sum() > 0.97 * mission.initial.n_items.sum(), "it was 30 % once"
