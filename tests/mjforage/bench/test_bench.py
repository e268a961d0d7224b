from collections.abc import Callable
from typing import Any

import pytest

from mjforage.bench import decisions, running, workloads
from mjforage.bench.decisions import decision_times, fleet_setup
from mjforage.bench.running import Rate, rate
from mjforage.mission.mission import Mission
from mjforage.physics.simulation.integrators import Integrator
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario


@pytest.mark.parametrize(
    ("work", "amount"),
    [
        (lambda: workloads._hashing(10), 10.0),
        (lambda: workloads._graph("random", 2, "horizon=7"), 2 * 7),
        (lambda: workloads._physics_mission(2, 3), 2 * 3 * 10.0),
        (lambda: workloads._simulation(Integrator.FAST, 5.0), 5.0),
        (lambda: workloads._environment(2, 3), 2 * 3),
        (lambda: workloads._hulls_batch(2), 2 * workloads.DECISIONS),
        (lambda: workloads._hulls_environment(2, 2), 2 * workloads.DECISIONS),
        (lambda: workloads._updates(2), 2),
    ],
)
def test_every_call_of_a_workload_does_the_same_work(work: object, amount: float) -> None:
    assert callable(work)
    made = work()
    assert [made(), made()] == [amount, amount]


def test_a_mission_and_an_environment_of_hulls_do_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Their rates differ by what the environment adds."""
    seen: list[Any] = []

    def noted(name: str) -> Callable[..., Any]:
        call = getattr(Mission, name)

        def noting(mission: Mission, *given: Any) -> Any:
            found = call(mission, *given)
            seen.append((name, mission.keys.tolist(), mission.state.agent_yaw.tolist()))
            return found

        return noting

    for name in ("start", "restart", "advance"):
        monkeypatch.setattr(Mission, name, noted(name))
    workloads._hulls_batch(3)()
    alone = seen.copy()
    seen.clear()
    workloads._hulls_environment(3)()
    assert seen == alone and len(seen) == workloads.DECISIONS + 3


def test_keys_say_what_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    played: list[Scenario] = []

    def noted(*given: Any) -> Scenario:
        played.append(load_scenario(*given))
        return played[-1]

    monkeypatch.setattr(workloads, "load_scenario", noted)
    for case in ("greedy", "greedy_link", "belief_link", "belief_misses"):
        workloads.WORKLOADS[f"graph_{case}"].make()
    found = [(one.link.model, one.sensors.detection) for one in played]
    assert found == [("ideal", 1.0), ("disk", 1.0), ("disk", 1.0), ("ideal", 0.9)]


def test_a_rate_is_the_median_of_slices_and_the_quickest(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first call, which compiles, is none of them."""
    slices = iter([(8.0, 4.0), (8.0, 1.0), (8.0, 2.0)])
    monkeypatch.setattr(running, "REPEATS", 3)
    monkeypatch.setattr(running, "slice_of", lambda *given: next(slices))
    calls = iter([100.0])
    assert rate(lambda: next(calls)) == Rate(value=4.0, quickest=8.0)
    assert not list(calls)


def test_fleets_are_half_scouts() -> None:
    fleet = fleet_setup(16).fleet
    assert len(fleet) == 16
    assert fleet.collectors.size == 8


def test_every_policy_has_a_time_with_every_fleet(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decisions, "EPISODES", 2)
    monkeypatch.setattr(decisions, "REPEATS", 1)
    times = decision_times(("random", "no_weights_of_this_name"), (2, 4), horizon=6)
    assert [one.agents for one in times] == [2, 2, 4, 4]
    for one in times:
        assert (0.0 < one.low <= one.ms <= one.high) == (one.policy == "random")
        assert (one.policy in one.reason) == (one.policy != "random")
