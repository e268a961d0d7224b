import numpy as np
import pytest

from mjforage.controllers import Chart
from mjforage.mission.dynamics import ARRIVED, BLOCKED, LATE
from mjforage.physics.dynamics.period_monitor import (
    MonitorSetup,
    Motion,
    PeriodRecord,
    Tick,
    judge,
    monitor,
)
from mjforage.physics.hydrodynamics.parameters import pack_fleet
from mjforage.physics.hydrodynamics.power import drawn_power
from mjforage.physics.vessels import load_vessel

OTTER = load_vessel("otter")
OPEN = Chart(np.ones((5, 5), np.bool_), 4.0).land
ON = np.ones(1, np.bool_)
SETUP = MonitorSetup(pack_fleet([OTTER]), np.array([[1.0, 0.54]]), OPEN, 4.0, 0.1)


def noted(
    seen: PeriodRecord,
    ticks: int,
    *,
    at: tuple[float, float] = (8.0, 8.0),
    speed: float = 0.0,
    target: tuple[float, float] = (0.0, 0.0),
    giving_way: bool = False,
    lagged: float = 0.0,
) -> None:
    """The same tick several times: one otter heading east at `speed`, 0.1 s each."""
    pose = np.array([[[*at, 0.0]]])
    before = pose - [0.1 * speed, 0.0, 0.0]
    velocity = np.array([[[speed, 0.0, 0.0]]])
    for _ in range(ticks):
        tick = Tick(
            before=Motion(before, velocity),
            after=Motion(pose, velocity),
            target=np.array([[target]]),
            giving_way=np.full((1, 1), giving_way),
            met=pose,
            lagged=np.full((1, 1, 2), lagged),
        )
        monitor(SETUP, seen, ON, tick)


def outcome(seen: PeriodRecord, *, no_move: bool = False) -> int:
    result = np.full((1, 1), 9, np.int8)
    judge(ON, np.full((1, 1), no_move), seen, result)
    return int(result[0, 0])


def test_within_a_metre_of_the_target_is_arrived_for_the_rest_of_the_period() -> None:
    seen = PeriodRecord.of((1, 1))
    noted(seen, 1, target=(9.01, 8.0))
    assert outcome(seen) == LATE
    noted(seen, 1, target=(8.59, 8.8))
    noted(seen, 30, target=(0.0, 0.0), giving_way=True)
    assert outcome(seen) == ARRIVED
    assert outcome(seen, no_move=True) == BLOCKED
    seen.begin(ON)
    assert outcome(seen) == LATE


def test_slow_for_two_seconds_without_a_break_and_for_a_reason_is_blocked() -> None:
    seen = PeriodRecord.of((1, 1))
    noted(seen, 40)  # slow for no reason
    noted(seen, 19, giving_way=True)
    noted(seen, 1, speed=0.11, giving_way=True)
    noted(seen, 19, giving_way=True)
    assert outcome(seen) == LATE
    noted(seen, 1, speed=0.09, giving_way=True)
    assert outcome(seen) == BLOCKED
    seen.begin(ON)
    noted(seen, 19, giving_way=True)
    assert outcome(seen) == LATE, "every period counts its own"


def test_contact_is_a_reason_and_counts_once_per_touch() -> None:
    seen = PeriodRecord.of((1, 1))
    noted(seen, 20, at=(17.0, 8.0), speed=0.05)  # bow at the east edge, x = 18
    assert outcome(seen) == BLOCKED
    noted(seen, 1)
    noted(seen, 1, at=(17.0, 8.0), speed=0.25)
    assert seen.collisions.tolist() == [[2]]
    assert seen.impact_mps.tolist() == [[0.25]]
    seen.begin(ON)
    assert seen.collisions.tolist() == [[2]]
    assert seen.impact_mps.tolist() == [[0.0]]


def test_way_and_energy_add_up() -> None:
    seen = PeriodRecord.of((1, 1))
    noted(seen, 50, speed=1.5, lagged=60.0)
    assert seen.travelled_m[0, 0] == pytest.approx(7.5)
    assert seen.work_j[0, 0] == pytest.approx(5.0 * drawn_power(SETUP.vessels[0], 60.0, 60.0))
    seen.begin(ON)
    assert seen.travelled_m[0, 0] == 0.0
    assert seen.work_j[0, 0] > 0.0
