"""Passing looks on: to all in contact, the newest first, one hop per decision.

Those in contact know which looks the others lack (they exchange digests, which take no budget and
are never lost or late: an idealisation). What was sent is charged
to the sender's budget whether it is lost or not. Looks in flight are not sent again.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.look_log import LookLog
from graph_planner.randomness import Stream, stream_key, uniform
from mjforage.core.link.contacts import Contacts
from mjforage.core.link.propagation import packet_error

NOT_HEARD = -1
LAST = np.iinfo(np.int16).max  # step of what arrives after the end
LOOK_BYTES, NODE_BYTES = 6, 3  # of a look, and more of every occupied node in it
_ARRIVING = -2


class Terms(NamedTuple):
    """What may be sent."""

    latency: int  # decisions
    bytes: int  # per sender and decision, 0 without a limit
    cells: int  # the same in cells
    passes_on: NDArray[np.bool_]  # (agent,) looks of others too


class Mail(NamedTuple):
    """Which looks holders have heard; a holder per agent."""

    heard_at: NDArray[np.int16]  # (episode, holder, agent, step) step of arrival, or `NOT_HEARD`
    complete: NDArray[np.int64]  # (episode,) all looks up to this step are heard or in flight
    flying: NDArray[np.int64]  # (episode,) looks sent that have not arrived
    arriving: NDArray[np.int64]  # memory: flat places in `heard_at` of an episode


class Traffic(NamedTuple):
    """What went over the links so far, per episode (episode,)."""

    contacts: NDArray[np.int64]  # pairs in contact, summed over decisions
    sent: NDArray[np.int64]  # looks, once for each sender and receiver that lacks them
    lost: NDArray[np.int64]  # of those
    dropped: NDArray[np.int64]  # looks that a budget did not suffice for, in every decision anew
    bytes: NDArray[np.int64]


def mail(episodes: int, agents: int, horizon: int) -> Mail:
    """Nothing heard yet."""
    size = agents * agents * (horizon + 1)
    return Mail(
        np.full((episodes, agents, agents, horizon + 1), NOT_HEARD, np.int16),
        np.full(episodes, -1, np.int64),
        np.zeros(episodes, np.int64),
        np.empty(size, np.int64),
    )


def traffic(episodes: int) -> Traffic:
    """Nothing sent yet."""
    return Traffic(*(np.zeros(episodes, np.int64) for _ in Traffic._fields))


@kernel
def _garbled(key: np.uint64, step: int, index: int, snr_db: float, size: int) -> bool:
    """Whether noise garbles a packet."""
    if snr_db == np.inf:
        return False
    return bool(uniform(stream_key(key, Stream.PACKETS), index, step) < packet_error(snr_db, size))


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
    mail: Mail,
    traffic: Traffic,
    number: int,
) -> int:
    """Send agent i's copy of a look to all in contact that lack it; arrivals listed so far."""
    heard_at, agents, steps = mail.heard_at, mail.heard_at.shape[1], mail.heard_at.shape[3]
    for j in range(agents):
        if j == i or contacts.snr_db[e, i, j] < 0.0 or heard_at[e, j, a, s] >= 0:
            continue
        traffic.sent[e] += 1
        snr, place = contacts.snr_db[e, i, j], (j * agents + a) * steps + s
        if contacts.bad[e, i, j] or _garbled(
            key, now, i * agents * agents * steps + place, snr, size
        ):
            traffic.lost[e] += 1
            contacts.lost[e, i, j] += 1
        elif heard_at[e, j, a, s] == NOT_HEARD:
            heard_at[e, j, a, s] = _ARRIVING
            mail.arriving[number] = place
            number += 1
    return number


@kernel
def _wanted(e: int, i: int, a: int, s: int, contacts: Contacts, mail: Mail) -> bool:
    """Whether somebody in contact with agent i lacks a look."""
    wanted = False
    for j in range(mail.heard_at.shape[1]):
        lacks = mail.heard_at[e, j, a, s] < 0
        wanted |= j != i and contacts.snr_db[e, i, j] >= 0.0 and lacks
    return wanted


@kernel
def _send(
    terms: Terms,
    key: np.uint64,
    e: int,
    now: int,
    i: int,
    log: LookLog,
    contacts: Contacts,
    mail: Mail,
    traffic: Traffic,
    number: int,
) -> int:
    """Let agent i pass on what others lack, the newest first, ties by agent."""
    if contacts.snr_db[e, i].max() < 0.0:
        return number
    bytes_left = terms.bytes if terms.bytes > 0 else np.iinfo(np.int64).max
    cells_left = terms.cells if terms.cells > 0 else np.iinfo(np.int64).max
    for s in range(now, mail.complete[e], -1):
        for a in range(mail.heard_at.shape[1]):
            at = mail.heard_at[e, i, a, s]
            if at < 0 or at > now or (a != i and not terms.passes_on[i]):
                continue
            if not _wanted(e, i, a, s, contacts, mail):
                continue
            size = LOOK_BYTES + NODE_BYTES * log.occupied[e, s, a]
            cells = 1 + log.occupied[e, s, a]
            if size > bytes_left or cells > cells_left:
                traffic.dropped[e] += 1
                continue
            bytes_left, cells_left = bytes_left - size, cells_left - cells
            traffic.bytes[e] += size
            number = _deliver(key, e, now, i, a, s, size, contacts, mail, traffic, number)
    return number


@kernel
def pass_on(
    terms: Terms,
    key: np.uint64,
    e: int,
    now: int,
    log: LookLog,
    contacts: Contacts,
    mail: Mail,
    traffic: Traffic,
) -> None:
    """Exchange looks over the links of a decision.

    What arrives at once is passed on in the next decision at the earliest: all send what they had
    heard before.

    Parameters
    ----------
    key : of episode `e`
    now : the step; everybody's own look of it has been heard by its agent
    mail, traffic : changed, as is what `contacts` count as lost
    """
    agents, number = mail.heard_at.shape[1], 0
    for i in range(agents):
        for j in range(i):
            traffic.contacts[e] += contacts.snr_db[e, i, j] >= 0.0
    for i in range(agents):
        number = _send(terms, key, e, now, i, log, contacts, mail, traffic, number)
    mail.flying[e] += number
    heard_at = mail.heard_at[e].reshape(-1)
    for k in range(number):
        heard_at[mail.arriving[k]] = min(now + terms.latency, LAST)
    while mail.complete[e] < now and mail.heard_at[e, :, :, mail.complete[e] + 1].min() >= 0:
        mail.complete[e] += 1
