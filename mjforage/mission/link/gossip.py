"""Passing scans on: to all in contact, the newest first, one hop per decision.

Those in contact know which scans the others lack (they exchange digests, which take no budget and
are never lost or delayed: an idealisation). What was sent is charged
to the sender's budget whether it is lost or not. Scans in flight are not sent again.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.randomness import Stream, UInt64Array, stream_key, uniform
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.link.contacts import Contacts
from mjforage.mission.link.propagation import packet_error
from mjforage.mission.scan_log import ScanLog
from mjforage.scenario.link import NODE_BYTES, SCAN_BYTES

NOT_RECEIVED = -1
LAST = np.iinfo(np.int16).max  # step of what arrives after the end
_ARRIVING = -2
_NEVER = np.iinfo(np.int64).max


class Terms(NamedTuple):
    """Limits on what is sent."""

    latency: int  # decisions
    bytes: int  # per sender and decision, 0 without a limit
    cells: int  # the same in cells
    passes_on: NDArray[np.bool_]  # (agent,) scans of others too


class Inbox(NamedTuple):
    """Scans that owners have received; one owner per agent."""

    received_at: NDArray[np.int16]  # (episode, owner, agent, step) of arrival, or `NOT_RECEIVED`
    newest: NDArray[np.int64]  # (episode, owner, agent) step of the newest received or in flight
    complete: NDArray[np.int64]  # (episode, owner, agent) all up to this step are
    arrived: NDArray[np.int64]  # (episode, owner, agent) all up to this step are received
    in_flight: NDArray[np.int64]  # (episode,) copies of scans sent that have not arrived
    due: NDArray[np.int64]  # (episode, step) copies that arrive then, whoever else sent them
    arriving: NDArray[np.int64]  # memory: flat places in `received_at` of an episode
    wanted: NDArray[np.int64]  # (agent, 2) memory: first and last step of what to scan through
    received: Int32Array  # (scan, 4) memory: row, episode, step and agent of what is received


class Traffic(NamedTuple):
    """Traffic over the links so far, per episode (episode,)."""

    contacts: NDArray[np.int64]  # pairs in contact, summed over decisions
    sent: NDArray[np.int64]  # scans, once for each sender and receiver that lacks them
    lost: NDArray[np.int64]  # of those
    dropped: NDArray[np.int64]  # scans that a budget did not suffice for, in every decision anew
    bytes: NDArray[np.int64]


def inbox(episodes: int, agents: int, horizon: int) -> Inbox:
    """Empty inboxes."""
    pairs, scans = (episodes, agents, agents), agents * agents * (horizon + 1)
    return Inbox(
        received_at=np.full((*pairs, horizon + 1), NOT_RECEIVED, np.int16),
        newest=np.full(pairs, NOT_RECEIVED, np.int64),
        complete=np.full(pairs, NOT_RECEIVED, np.int64),
        arrived=np.full(pairs, NOT_RECEIVED, np.int64),
        in_flight=np.zeros(episodes, np.int64),
        due=np.zeros((episodes, horizon + 1), np.int64),
        arriving=np.empty(scans, np.int64),
        wanted=np.empty((agents, 2), np.int64),
        received=np.empty((scans, 4), np.int32),
    )


def traffic(episodes: int) -> Traffic:
    """Counts of traffic before anything was sent."""
    return Traffic(*(np.zeros(episodes, np.int64) for _ in Traffic._fields))


@kernel
def _garbled(key: np.uint64, step: int, index: int, snr_db: float, size: int) -> bool:
    """True if noise garbles a packet."""
    if snr_db == np.inf:
        return False
    return bool(uniform(stream_key(key, Stream.PACKETS), index, step) < packet_error(snr_db, size))


@inlined
def _lacks(
    received_at: NDArray[np.int16],
    snr_db: NDArray[np.float64],
    e: int,
    i: int,
    j: int,
    a: int,
    s: int,
) -> bool:
    """True if agent j is in contact with agent i and has not received a scan of agent a."""
    return bool(j != i and snr_db[e, i, j] >= 0.0 and received_at[e, j, a, s] < 0)


@kernel
def _deliver(
    key: np.uint64,
    e: int,
    now: int,
    i: int,
    a: int,
    s: int,
    size: int,
    contacts: Contacts,
    inbox: Inbox,
    traffic: Traffic,
    number: int,
) -> int:
    """Send agent i's copy of a scan to all in contact that lack it; arrivals listed so far."""
    received_at, snr_db = inbox.received_at, contacts.snr_db
    agents, steps = received_at.shape[1], received_at.shape[3]
    for j in range(agents):
        if not _lacks(received_at, snr_db, e, i, j, a, s):
            continue
        traffic.sent[e] += 1
        place = (j * agents + a) * steps + s
        if contacts.bad[e, i, j] or _garbled(
            key, now, i * agents * agents * steps + place, snr_db[e, i, j], size
        ):
            traffic.lost[e] += 1
            contacts.lost[e, i, j] += 1
        elif received_at[e, j, a, s] == NOT_RECEIVED:
            received_at[e, j, a, s] = _ARRIVING
            inbox.arriving[number] = place
            number += 1
    return number


@inlined
def _span_of_scans(
    e: int,
    i: int,
    passes_on: NDArray[np.bool_],
    snr_db: NDArray[np.float64],
    newest: NDArray[np.int64],
    complete: NDArray[np.int64],
    wanted: NDArray[np.int64],
) -> tuple[int, int]:
    """First and last step of the scans that agent i may have and some in contact may lack.

    So that what all have had for long is not gone through in every decision.

    `wanted`: (agent, 2) the same of each agent's scans, filled in.
    """
    first, last = _NEVER, -1
    for a in range(passes_on.size):
        low, high = _NEVER, -1
        if a == i or passes_on[i]:
            high = newest[e, i, a]
            for j in range(passes_on.size):
                if j != i and snr_db[e, i, j] >= 0.0:
                    low = min(low, complete[e, j, a] + 1)
        wanted[a, 0], wanted[a, 1] = low, high
        if low <= high:
            first, last = min(first, low), max(last, high)
    return first, last


@inlined
def _note_arrival(
    e: int,
    place: int,
    at: int,
    received_at: NDArray[np.int16],
    newest: NDArray[np.int64],
    complete: NDArray[np.int64],
) -> None:
    """Note when the scan of a flat place in `received_at` arrives."""
    agents, steps = received_at.shape[1], received_at.shape[3]
    j, a, s = place // (agents * steps), place // steps % agents, place % steps
    received_at[e, j, a, s] = at
    newest[e, j, a] = max(newest[e, j, a], s)
    upto = complete[e, j, a]
    while upto + 1 < steps and received_at[e, j, a, upto + 1] >= 0:
        upto += 1
    complete[e, j, a] = upto


@kernel
def _exchange(
    terms: Terms,
    key: np.uint64,
    e: int,
    now: int,
    log: ScanLog,
    contacts: Contacts,
    inbox: Inbox,
    traffic: Traffic,
) -> int:
    """All send what others lack, the newest first, ties by agent; how many scans will arrive."""
    snr_db, received_at = contacts.snr_db, inbox.received_at
    newest, complete = inbox.newest, inbox.complete
    wanted, occupied, agents, number = inbox.wanted, log.occupied, received_at.shape[1], 0
    for i in range(agents):
        bytes_left = terms.bytes if terms.bytes > 0 else _NEVER
        cells_left = terms.cells if terms.cells > 0 else _NEVER
        first, last = _span_of_scans(e, i, terms.passes_on, snr_db, newest, complete, wanted)
        for s in range(last, first - 1, -1):
            for a in range(agents):
                if s < wanted[a, 0] or s > wanted[a, 1] or not 0 <= received_at[e, i, a, s] <= now:
                    continue
                lacking = 0
                for j in range(agents):
                    lacking += _lacks(received_at, snr_db, e, i, j, a, s)
                if lacking == 0:
                    continue
                size, cells = SCAN_BYTES + NODE_BYTES * occupied[e, s, a], 1 + occupied[e, s, a]
                if size > bytes_left or cells > cells_left:
                    traffic.dropped[e] += 1
                    continue
                bytes_left, cells_left = bytes_left - size, cells_left - cells
                traffic.bytes[e] += size
                number = _deliver(key, e, now, i, a, s, size, contacts, inbox, traffic, number)
    return number


@kernel
def pass_on(
    terms: Terms,
    keys: UInt64Array,
    active: NDArray[np.bool_],
    step: Int32Array,
    log: ScanLog,
    contacts: Contacts,
    inbox: Inbox,
    traffic: Traffic,
) -> None:
    """Exchange scans over the links of a decision, after every agent's own scan of it.

    What arrives at once is passed on in the next decision at the earliest: all send what they had
    received before.

    Parameters
    ----------
    keys, active, step : (episode,)
    inbox, traffic : changed in active episodes, as is what `contacts` count as lost
    """
    received_at, arriving = inbox.received_at, inbox.arriving
    newest, complete = inbox.newest, inbox.complete
    agents, steps, snr_db = received_at.shape[1], received_at.shape[3], contacts.snr_db
    met, sent, lost = traffic.contacts, traffic.sent, traffic.lost
    for e in range(active.size):
        if not active[e]:
            continue
        now = step[e]
        for i in range(agents):
            _note_arrival(e, (i * agents + i) * steps + now, now, received_at, newest, complete)
            for j in range(i):
                met[e] += snr_db[e, i, j] >= 0.0
        before = sent[e] - lost[e]
        number = _exchange(terms, keys[e], e, now, log, contacts, inbox, traffic)
        copies, at = sent[e] - lost[e] - before, min(now + terms.latency, LAST)
        inbox.in_flight[e] += copies
        if at < steps:
            inbox.due[e, at] += copies
        for k in range(number):
            _note_arrival(e, arriving[k], at, received_at, newest, complete)


@kernel
def arrivals(e: int, now: int, inbox: Inbox) -> int:
    """List in `inbox.received` the scans received now in an episode, by owner, step and agent.

    Returns: how many scans.
    """
    received_at, newest = inbox.received_at, inbox.newest
    arrived, received = inbox.arrived, inbox.received
    agents, number = received_at.shape[1], 0
    for h in range(agents):
        first = now
        for a in range(agents):
            if arrived[e, h, a] < newest[e, h, a]:
                first = min(first, arrived[e, h, a] + 1)
        for s in range(first, now + 1):
            for a in range(agents):
                if received_at[e, h, a, s] == now:
                    received[number, 0], received[number, 1] = e * agents + h, e
                    received[number, 2], received[number, 3] = s, a
                    number += 1
        for a in range(agents):
            while arrived[e, h, a] < now and 0 <= received_at[e, h, a, arrived[e, h, a] + 1] <= now:
                arrived[e, h, a] += 1
    inbox.in_flight[e] -= inbox.due[e, now]
    return number
