"""The chances of a mission's agents to take an item, from the capture models of their vessels."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.mission.task import Pickup
from mjforage.scenario.capture import (
    DECISIONS,
    FROM_DEG,
    FROM_M,
    QUAYS,
    Capture,
    load_capture,
    usual_capture,
)
from mjforage.scenario.roles import Fleet
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.vessel_files import hull_names

FloatArray = NDArray[np.float64]
NEXT_M = 3.0, 5.0  # distances of cells in which items of the next node lie, of nodes of 4 m
_CELLS = len(QUAYS), len(FROM_M), len(FROM_DEG)


class Chances(NamedTuple):
    """Capture probabilities of each agent."""

    first: FloatArray  # (agent, quays, distance, bearing, decision) not taken before
    follow: FloatArray  # (agent, quays) after another one in the same decision
    pitch_m: float  # side of a node


def chances_of(fleet: Fleet, scenario: Scenario) -> Chances | None:
    """Capture probabilities of each agent, or None where all agents collect everything.

    Raises `UserError` if a collecting vessel has no capture model, or one for another period.
    """
    if scenario.rules.capture == "certain":
        return None
    first, follow = np.zeros((len(fleet), *_CELLS, DECISIONS)), np.zeros((len(fleet), len(QUAYS)))
    names = hull_names(fleet, scenario.physics)
    for agent in fleet.collectors:
        capture = load_capture(names[agent])
        if capture.period_s != scenario.period_s:
            raise UserError(
                f"rules.capture = 'calibrated': vessel {names[agent]} was calibrated for decisions "
                f"of {capture.period_s:g} s; set period_s={capture.period_s:g}"
            )
        first[agent], follow[agent] = chances_from(capture)
    return Chances(first, follow, scenario.map.pitch_m)


def pickup_of(fleet: Fleet, scenario: Scenario) -> Pickup:
    """Mean delays of collecting for a fleet, see `usual_capture`; 0 for other agents.

    Raises `UserError` if a capture model is not a valid one.
    """
    first, more = np.zeros((len(fleet), len(QUAYS), len(FROM_DEG))), np.zeros(len(fleet))
    names = hull_names(fleet, scenario.physics)
    for agent in fleet.collectors:
        capture = usual_capture(names[agent])
        periods = capture.period_s / scenario.period_s
        first[agent], more[agent] = delays_from(capture)
        first[agent], more[agent] = periods * first[agent], periods * more[agent]
    return Pickup(first, more)


def delays_from(capture: Capture) -> tuple[FloatArray, float]:
    """Decisions lost over a first item (quays, bearing), and over one more, see `Pickup`.

    Mean over the distances of items in the next node, from `NEXT_M` on: a sum of chances that it
    is still there after every decision, the last one's chance from there on.
    """
    chances, follow = chances_from(capture)
    chances = chances[:, [FROM_M.index(far) for far in NEXT_M]]
    left, lost = 1.0 - chances[..., 0], np.zeros(chances.shape[:-1])
    for decision in range(1, DECISIONS):
        lost += left
        left = left * (1.0 - chances[..., decision])
    lost += left / chances[..., -1]
    tried = np.array([both.trials for both in capture.follows])
    return lost.mean(axis=1), float(1.0 - (follow * tried).sum() / tried.sum())


def chances_from(capture: Capture) -> tuple[FloatArray, FloatArray]:
    """Chances of a hull, (quays, distance, bearing, decision) and (quays,), from counts.

    By the rule of succession (Laplace 1814), (taken + 1) / (trials + 2): never quite 0 or 1.
    """
    first, follow = np.zeros((*_CELLS, DECISIONS)), np.zeros(len(QUAYS))
    for cell in capture.cells:
        place = QUAYS.index(cell.quays), FROM_M.index(cell.from_m), FROM_DEG.index(cell.from_deg)
        taken = np.array(cell.taken)
        left = cell.trials - np.cumsum(taken) + taken
        first[place] = (taken + 1) / (left + 2)
    for both in capture.follows:
        follow[QUAYS.index(both.quays)] = (both.taken + 1) / (both.trials + 2)
    return first, follow
