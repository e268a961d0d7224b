"""Passing scans on, by hand: three agents, of whom each has made a scan in every step."""

from typing import Any

import numpy as np
import pytest

from mjforage.base.randomness import Stream
from mjforage.mission.link.contacts import Contacts
from mjforage.mission.link.gossip import (
    LAST,
    NOT_RECEIVED,
    Terms,
    _garbled,
    arrivals,
    inbox,
    pass_on,
    traffic,
)
from mjforage.mission.link.propagation import packet_error
from mjforage.mission.link.reach import reach_m
from mjforage.mission.scan_log import ScanLog
from mjforage.scenario.link import Link
from tests.mjforage.mission.slow_minds import drawn

AGENTS, HORIZON = 3, 8
KEYS, HERE = np.array([5], np.uint64), np.array([True])
EMPTY, TWO = 6, 12  # bytes of a scan with nothing in it, and with two occupied nodes


class Talk:
    """A talk of three, of whom only the pairs named are in contact."""

    def __init__(self, *pairs: tuple[int, int], snr_db: float = np.inf, **terms: Any) -> None:
        self.contacts = Contacts.of(1, AGENTS)
        for i, j in pairs:
            self.contacts.snr_db[0, i, j] = self.contacts.snr_db[0, j, i] = snr_db
        given: dict[str, Any] = {
            "latency": 0,
            "bytes": 0,
            "cells": 0,
            "passes_on": np.ones(AGENTS, np.bool_),
        }
        self.terms = Terms(**(given | terms))
        self.inbox, self.traffic = inbox(1, AGENTS, HORIZON), traffic(1)
        each = (1, HORIZON + 1, AGENTS)
        kinds: dict[str, Any] = {name: np.zeros(each) for name in ScanLog._fields}
        self.log = ScanLog(**kinds | {"occupied": np.zeros(each, np.int32)})

    def step(self, now: int) -> None:
        about = self.log, self.contacts, self.inbox, self.traffic
        pass_on(self.terms, KEYS, HERE, np.array([now], np.int32), *about)

    def receive(self, now: int) -> list[tuple[int, int, int]]:
        """What arrives: owner, step and agent."""
        number = arrivals(0, now, self.inbox)
        return [(h, s, a) for h, _, s, a in self.inbox.received[:number].tolist()]

    def received(self, owner: int, agent: int, step: int) -> int:
        return int(self.inbox.received_at[0, owner, agent, step])


def test_the_newest_goes_first_where_not_all_can_go() -> None:
    """One empty scan a decision: what was made before the contact waits behind what is new."""
    talk = Talk(bytes=EMPTY)
    talk.step(0)
    talk.contacts.snr_db[0, 0, 1] = talk.contacts.snr_db[0, 1, 0] = np.inf
    talk.step(1)
    assert (talk.received(1, 0, 1), talk.received(1, 0, 0)) == (1, NOT_RECEIVED)
    assert talk.traffic.dropped[0] == 2 and talk.traffic.bytes[0] == 2 * EMPTY


def test_a_scan_takes_six_bytes_and_three_for_each_occupied_node() -> None:
    for most, comes in ((TWO, True), (TWO - 1, False)):
        talk = Talk((0, 1), bytes=most)
        talk.log.occupied[0, 0, 0] = 2
        talk.step(0)
        assert (talk.received(1, 0, 0) == 0) == comes
    talk = Talk((0, 1), cells=2)
    talk.log.occupied[0, 0] = 2
    talk.step(0)
    assert talk.received(1, 0, 0) == NOT_RECEIVED and talk.traffic.dropped[0] == 2


def test_what_is_under_way_is_neither_sent_again_nor_passed_on() -> None:
    """0 to 1 to 2 with a latency of two: at 2 two hops and twice the latency later."""
    talk = Talk((0, 1), (1, 2), latency=2)
    for now in range(5):
        talk.step(now)
        assert talk.received(1, 0, 0) == 2
        assert talk.received(2, 0, 0) == (4 if now >= 2 else NOT_RECEIVED)
    links = 4
    assert talk.traffic.sent[0] == 5 * links + 2 * 3, "each once, and passed on from step 2"
    assert talk.inbox.in_flight[0] == talk.traffic.sent[0]


def test_what_arrives_is_received_once_in_the_order_of_its_steps() -> None:
    """The first scan of 0 is lost, and comes two decisions after the second."""
    talk = Talk((0, 1), latency=2)
    talk.contacts.bad[0, 0, 1] = True
    own = [(0, 0), (1, 1), (2, 2)]
    for now in range(6):
        talk.step(now)
        talk.contacts.bad[:] = False
        if now == 1:
            talk.inbox.received_at[0, 1, 0, 0] = 5  # the lost one is still longer under way
            talk.inbox.due[0, [3, 5]] += [-1, 1]
        expected = [(h, now, a) for h, a in own]
        expected += [(0, now - 2, 1)] * (now >= 2) + [(1, now - 2, 0)] * (now >= 3)
        expected += [(1, 0, 0)] * (now == 5)
        received = talk.receive(now)
        assert received == sorted(received) and sorted(expected) == received
        assert talk.inbox.arrived[0, 1, 0] == (-1 if now < 5 else 3)
        left = sum(1 for at in talk.inbox.received_at[0].ravel() if at > now)
        assert talk.inbox.in_flight[0] == left


def test_a_scan_that_two_send_at_once_is_under_way_twice() -> None:
    """0 and 1 both tell 2 of the scan of 0: the second copy has not arrived either."""
    talk = Talk((0, 1), latency=1)
    talk.step(0)
    talk.receive(0)
    talk.contacts.snr_db[0, :, 2] = talk.contacts.snr_db[0, 2, :] = np.inf
    talk.step(1)
    talk.receive(1)
    copies = int(talk.traffic.sent[0]) - 2  # of which the first two have arrived
    assert talk.inbox.in_flight[0] == copies > (talk.inbox.received_at == 2).sum()


def test_what_arrives_after_the_end_arrives_never() -> None:
    talk = Talk((0, 1), latency=30000)
    talk.step(0)
    assert talk.received(1, 0, 0) == 30000
    talk = Talk((0, 1), latency=40000)
    talk.step(0)
    assert talk.received(1, 0, 0) == LAST


def test_what_all_in_contact_have_had_is_not_gone_through_again() -> None:
    """0 and 1 in contact from step 3, 2 far: whoever comes back is told all that it lacks."""
    talk = Talk()
    for now in range(3):
        talk.step(now)
    talk.contacts.snr_db[0, 0, 1] = talk.contacts.snr_db[0, 1, 0] = np.inf
    talk.step(3)
    assert [talk.received(1, 0, s) for s in range(4)] == [3, 3, 3, 3]
    assert talk.inbox.complete[0, 1].tolist() == [3, 3, -1]
    talk.contacts.snr_db[0, 1, 2] = talk.contacts.snr_db[0, 2, 1] = np.inf
    talk.step(4)
    assert [talk.received(2, 0, s) for s in range(5)] == [4, 4, 4, 4, NOT_RECEIVED]
    assert [talk.received(1, 2, s) for s in range(5)] == [4, 4, 4, 4, 4]
    talk.step(5)
    assert talk.received(2, 0, 4) == 5 and talk.received(0, 2, 0) == 5
    assert talk.inbox.newest[0, 2, 0] == 4, "what 0 sees now comes over two hops"


def test_losses_are_counted_from_sender_to_receiver() -> None:
    """0 to 1 is bad and 1 to 0 is not: 1 lacks both scans of 0 at step 1, and loses them again."""
    talk = Talk((0, 1), (1, 2))
    talk.contacts.bad[0, 0, 1] = True
    talk.step(0)
    assert np.argwhere(talk.contacts.lost[0]).tolist() == [[0, 1]]
    assert talk.contacts.lost[0, 0, 1] == talk.traffic.lost[0] == 1
    talk.contacts.lost[:] = 0
    talk.step(1)
    assert np.argwhere(talk.contacts.lost[0]).tolist() == [[0, 1]]
    assert talk.contacts.lost[0, 0, 1] == 2 and talk.traffic.lost[0] == 1 + 2


@pytest.mark.parametrize(("snr_db", "share"), [(0.0, 0.98), (4.0, 0.45), (9.0, 0.0016)])
def test_noise_garbles_its_share_of_packets(snr_db: float, share: float) -> None:
    """Empty scans of 48 bits over QPSK, drawn for each sender, receiver, scan and decision."""
    lost = sent = 0
    for seed in range(150):
        talk = Talk((0, 1), (1, 2), (0, 2), snr_db=snr_db)
        about = talk.log, talk.contacts, talk.inbox, talk.traffic
        pass_on(talk.terms, np.array([seed], np.uint64), HERE, np.zeros(1, np.int32), *about)
        sent, lost = sent + int(talk.traffic.sent[0]), lost + int(talk.traffic.lost[0])
    assert sent == 150 * 6
    assert lost / sent == pytest.approx(share, abs=0.05)


def test_packets_have_draws_of_their_own() -> None:
    """Those that tell which links go bad are others."""
    chance, lost = packet_error(4.0, EMPTY), []
    for key in np.arange(40, dtype=np.uint64):
        draw = drawn(int(key), Stream.PACKETS, 3, 2)
        lost.append(_garbled(key, 2, 3, 4.0, EMPTY))
        assert lost[-1] == (draw < chance)
    assert 5 < sum(lost) < 35


def test_a_radio_reaches_as_far_as_scans_get_through() -> None:
    """Not as far as its power equals the noise: 1.2 km by default, where hardly any does."""
    masts = np.ones(2)
    far = reach_m(Link(model="log-distance"), masts)
    assert far == pytest.approx(10.0 ** ((117.0 - 40.0 - 3.73) / 25.0), rel=0.01)
    assert reach_m(Link(model="disk", range_m=64.0), masts) == 64.0
    assert reach_m(Link(), masts) == np.inf and reach_m(Link(model="none"), masts) == 0.0
    low = reach_m(Link(model="two-ray"), 0.5 * masts)
    assert low < reach_m(Link(model="two-ray"), masts), "masts help"
