"""Contacts: agents in reach of each other in a decision, and links that lose their scans."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.randomness import Stream, UInt64Array, normal, stream_key, uniform
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import NavigationGraph
from mjforage.mission.link.propagation import (
    gilbert_elliott,
    log_distance_loss_db,
    two_ray_loss_db,
    walls_between,
)
from mjforage.scenario.link import Link
from mjforage.scenario.roles import Fleet

MODELS = ("none", "disk", "log-distance", "two-ray")
_NONE, _DISK, _LOG_DISTANCE = range(3)


class Air(NamedTuple):
    """A link's model and the water that it bridges."""

    model: int  # place in `MODELS`
    range_m: float
    wall_db: float
    margin_db: float  # power of a transmitter over the noise
    frequency_hz: float
    exponent: float
    l0_db: float
    shadowing_db: float
    loss: float  # share of bad decisions
    turns_bad: float  # chance per decision of a good link
    turns_good: float  # and of a bad one
    antenna_m: NDArray[np.float64]  # (agent,)
    node_of_cell: Int32Array  # (row, column), -1 on land
    rows: Int32Array  # (node,)
    cols: Int32Array  # (node,)
    pitch_m: float

    @classmethod
    def of(cls, link: Link, graph: NavigationGraph, fleet: Fleet) -> "Air":
        """Air of a scenario's link, which must not be ideal."""
        turns_bad, turns_good = gilbert_elliott(link.loss, link.burst)
        return cls(
            MODELS.index(link.model),
            link.range_m,
            link.wall_db,
            link.tx_dbm - link.floor_dbm,
            link.frequency_hz,
            link.exponent,
            link.l0_db,
            link.shadowing_db,
            link.loss,
            turns_bad,
            turns_good,
            fleet.antenna_m,
            graph.node_of_cell,
            graph.rows,
            graph.cols,
            graph.pitch_m,
        )


class Contacts(NamedTuple):
    """Links of a batch in the decision just made."""

    snr_db: NDArray[np.float64]  # (episode, sender, receiver) signal to noise; below 0: no contact
    bad: NDArray[np.bool_]  # (episode, sender, receiver) whether all that is sent is lost
    lost: NDArray[np.int64]  # (episode, sender, receiver) scans that were, or that noise garbled

    @classmethod
    def of(cls, episodes: int, agents: int) -> "Contacts":
        """No contacts yet."""
        each = (episodes, agents, agents)
        return cls(np.full(each, -np.inf), np.zeros(each, np.bool_), np.zeros(each, np.int64))


@inlined
def _snr_db(air: Air, key: np.uint64, step: int, at: Int32Array, i: int, j: int) -> float:
    """Signal to noise between agents i and j [dB]; without a radio infinite, or minus infinite."""
    row, col, to_row, to_col = air.rows[at[i]], air.cols[at[i]], air.rows[at[j]], air.cols[at[j]]
    if air.model == _NONE:
        return -np.inf
    d_m = air.pitch_m * math.sqrt(float((to_row - row) ** 2 + (to_col - col) ** 2))
    walls = 0
    if air.wall_db > 0.0:
        walls = walls_between(air.node_of_cell, row, col, to_row, to_col)
    if air.model == _DISK:
        return np.inf if d_m <= air.range_m and walls == 0 else -np.inf
    if air.model == _LOG_DISTANCE:
        loss = log_distance_loss_db(d_m, air.exponent, air.l0_db)
    else:
        loss = two_ray_loss_db(d_m, air.antenna_m[i], air.antenna_m[j], air.frequency_hz)
    shadow = 0.0
    if air.shadowing_db > 0.0:
        shadow = air.shadowing_db * normal(stream_key(key, Stream.SHADOWING), i * at.size + j, step)
    return float(air.margin_db - loss - walls * air.wall_db + shadow)


@kernel
def _reach(
    air: Air, key: np.uint64, step: int, at: Int32Array, snr_db: NDArray[np.float64]
) -> None:
    """Work out the signal to noise (sender, receiver) between the agents of an episode."""
    for i in range(at.size):
        for j in range(i):
            snr_db[i, j] = snr_db[j, i] = _snr_db(air, key, step, at, j, i)


@kernel
def connect(
    air: Air,
    keys: UInt64Array,
    active: NDArray[np.bool_],
    step: Int32Array,
    at: Int32Array,
    contacts: Contacts,
) -> None:
    """Work out the links at the end of a decision.

    Every directed link goes on being good or bad in every decision, whether in reach or not.

    Parameters
    ----------
    keys, active, step : (episode,)
    at : (episode, agent) true nodes
    contacts : changed in active episodes
    """
    agents, bad, lost = at.shape[1], contacts.bad, contacts.lost
    for e in range(active.size):
        if not active[e]:
            continue
        lost[e] = 0
        _reach(air, keys[e], step[e], at[e], contacts.snr_db[e])
        for i in range(agents if air.loss > 0.0 else 0):
            for j in range(agents):
                draw = uniform(stream_key(keys[e], Stream.LOSS), i * agents + j, step[e])
                if step[e] == 0:
                    bad[e, i, j] = draw < air.loss
                elif bad[e, i, j]:
                    bad[e, i, j] = draw >= air.turns_good
                else:
                    bad[e, i, j] = draw < air.turns_bad
