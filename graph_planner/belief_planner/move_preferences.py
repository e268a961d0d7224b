"""Preferences over the nine moves: towards a target, or near to where a hotspot may be."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner.ways import UNREACHED, Ways, row_to
from mjforage.graph_planner.graph.geodesics import Int32Array

ON_THE_WAY = 0.45  # most that items beside the way are worth, in decisions
NOT_HERE = 0.25  # decisions by which staying is worse than a move that leaves equally much to go
UNREACHABLE = 500.0  # decisions charged for a landmark out of reach


@kernel
def towards(
    ways: Ways, at: int, target: int, worth: NDArray[np.float64], preferences: NDArray[np.float64]
) -> None:
    """Prefer moves by the decisions left to the target after them, then by items passed.

    Parameters
    ----------
    at, target : nodes
    worth : (node,) items expected in each node now
    preferences : (9,) filled; -inf where a move is illegal
    """
    row = ways.decisions[row_to(ways, target)]
    for move in range(9):
        end = ways.ends[at, move]
        preferences[move] = -np.inf
        if end < 0:
            continue
        left = 1e5 if row[end] == UNREACHED else float(row[end])
        passed = worth[end]
        if end == at and at != target:
            left += NOT_HERE
            passed = 0.0
        preferences[move] = ON_THE_WAY * min(1.0, passed) - left


@kernel
def approach(
    ways: Ways,
    landmarks: Int32Array,
    mass: NDArray[np.float64],
    at: int,
    preferences: NDArray[np.float64],
) -> None:
    """Prefer moves after which the landmarks are fewest decisions away, weighted by mass.

    Step by step that is better than heading for the best place of all: the hotspot may be found
    at any moment.

    Parameters
    ----------
    landmarks : (landmark,) nodes
    mass : (landmark,)
    at : node of the forager
    preferences : (9,) filled; -inf where a move is illegal
    """
    preferences[:] = -np.inf
    for move in range(9):
        if ways.ends[at, move] >= 0:
            preferences[move] = 0.0
    for i in range(landmarks.size):
        if mass[i] <= 0.0:
            continue
        row = ways.decisions[row_to(ways, landmarks[i])]
        for move in range(9):
            end = ways.ends[at, move]
            if end >= 0:
                there = UNREACHABLE if row[end] == UNREACHED else float(row[end])
                preferences[move] -= mass[i] * there


@kernel
def regrets(
    ways: tuple[Ways, ...],
    landmarks: Int32Array,
    mass: NDArray[np.float64],
    kind: NDArray[np.int64],
    at: Int32Array,
    ahead: int,
) -> NDArray[np.float64]:
    """Cost to the foragers of a step of not knowing, if the hotspot is at a landmark.

    While it is not found they go on as `approach` says. A forager that comes nearer to the hotspot
    all the same loses nothing, one that goes the other way two steps in each. Returns: (landmark,)
    lost steps per forager and step, 0 to 2.

    `kind`, `at`: (forager,) its number in `ways`, and its node; `ahead`: steps looked at.
    """
    regret = np.zeros(landmarks.size)
    preferences = np.empty(9)
    for f in range(at.size):
        mine, here = ways[kind[f]], int(at[f])
        for _ in range(ahead):
            approach(mine, landmarks, mass, here, preferences)
            here = int(mine.ends[here, np.argmax(preferences)])
        for i in range(landmarks.size):
            row = mine.decisions[row_to(mine, landmarks[i])]
            lost = float(ahead) + float(row[here]) - float(row[at[f]])
            regret[i] += min(2.0, max(0.0, lost / ahead)) / at.size
    return regret
