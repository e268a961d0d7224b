import math

import pytest

from mjforage.bench import decisions
from mjforage.bench.decisions import decision_times, fleet_setup


def test_fleets_are_half_scouts() -> None:
    fleet = fleet_setup(16).fleet
    assert len(fleet) == 16
    assert fleet.collectors.size == 8


def test_every_policy_has_a_time_with_every_fleet(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decisions, "EPISODES", 2)
    monkeypatch.setattr(decisions, "REPEATS", 1)
    times = decision_times(("random", "greedy"), (2, 4), horizon=6)
    assert [(one.policy, one.agents) for one in times] == [
        ("random", 2),
        ("greedy", 2),
        ("random", 4),
        ("greedy", 4),
    ]
    assert all(0.0 < one.low <= one.ms <= one.high and not one.reason for one in times)


def test_who_cannot_play_is_told() -> None:
    missing = decision_times(("nobody_has_these_weights",), (2,), horizon=3)[0]
    assert math.isnan(missing.ms)
    assert "nobody_has_these_weights" in missing.reason
