import itertools
from collections.abc import Sequence
from functools import partial
from types import SimpleNamespace

import pytest

from mjforage.bench import learning as speeds
from mjforage.bench import rates, simulations
from mjforage.bench import running as bench
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario

HORIZON = "horizon=10"  # where the bench asks for no other


SLICES = {  # by hand: episodes x decisions, or so many things, in 2 s
    **{f"graph_{name}_steps_per_core_s": 2 * 10 / 2 for name in bench.POLICIES},
    **dict.fromkeys(("graph_belief_steps_per_core_s", "graph_belief_fast_steps_per_core_s"), 20.0),
    **{f"belief_decisions_{agents}_agents_per_core_s": 2 * 3 / 2 for agents in (4, 6)},
    **{f"graph_greedy_{name}_steps_per_core_s": 2 * 10 / 2 for name in ("link", "misses")},
    **{f"graph_belief_{name}_steps_per_core_s": 2 * 10 / 2 for name in ("link", "misses")},
    "greedy_decisions_6_holders_per_core_s": 8 * 3 / 2,
    "belief_decisions_6_holders_per_core_s": 2 * 3 / 2,
    "metrics_episodes_per_s": 2 / 2,
    **{f"graph_large_{name}_steps_per_core_s": 2 / 2 for name in ("random", "greedy")},
    **{f"physics_sim_s_per_core_s{kind}": 10 / 2 for kind in ("", "_reference", "_no_contacts")},
    "physics_steps_per_core_s": 100 / 2,  # of 0.1 s
    "physics_mission_sim_s_per_core_s": 8 * 12 * 10 / 2,
    **{f"env_obs_steps_per_core_s_{kind}": 2 * 3 * 4 / 2 for kind in ("egocentric", "paper")},
    **{f"env_steps_per_core_s_{name}": 2 * 3 / 2 for name in speeds.HANDED_OUT},
    "env_steps_per_core_s_uint8_reused_many": 3 * 3 / 2,
    "env_frames_per_core_s": 20 / 2,
    "ddqn_updates_per_s": 2 / 2,
}


def short(name: str, overrides: Sequence[str] = ()) -> Scenario:
    return load_scenario(name, (HORIZON, *overrides))


def test_bench_measures_every_promised_figure(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a tiny load and a clock on which every slice takes 2 s: half of the work it does."""
    ticks = itertools.count(0.0, 2.0)
    monkeypatch.setattr(rates, "time", SimpleNamespace(process_time=lambda: next(ticks)))
    for place in (bench, speeds):
        monkeypatch.setattr(place, "load_scenario", short)
    for name in ("callback_overhead", "mean_contacts"):
        monkeypatch.setattr(simulations, name, partial(getattr(simulations, name), simulations=2))
    monkeypatch.setattr(bench, "BATCH", 2)
    monkeypatch.setattr(rates, "REPEATS", 1)
    monkeypatch.setattr(bench, "BELIEF_BATCH", 4)
    monkeypatch.setattr(bench, "BELIEF_HORIZON", 3)
    monkeypatch.setattr(bench, "BELIEF_FLEETS", (4, 6))
    monkeypatch.setattr(bench, "LARGE_SHAPE", (90, 120))
    monkeypatch.setattr(bench, "LARGE_STEPS", 2)
    monkeypatch.setattr(bench, "PHYSICS_S", 10.0)
    monkeypatch.setattr(bench, "PHYSICS_BATCH", 1)
    monkeypatch.setattr(bench, "MISSION", (8, 12))
    monkeypatch.setattr(speeds, "ENVS", 2)
    monkeypatch.setattr(speeds, "MORE_ENVS", 2)
    monkeypatch.setattr(speeds, "MANY_ENVS", 3)
    monkeypatch.setattr(speeds, "STEPS", 3)
    monkeypatch.setattr(speeds, "ROUNDS", 1)
    monkeypatch.setattr(speeds, "UPDATES", 2)
    monkeypatch.setattr(speeds, "SMALL", {"num_envs": 1, "warmup": 10, "batch": 8})
    measured: list[str] = []
    figures = bench.bench(measured.append)
    assert {key: figures[key]["value"] for key in SLICES} == pytest.approx(SLICES)
    rest = {key: float(figure["value"]) for key, figure in figures.items() if key not in SLICES}
    for key in ("evaluate_greedy_steps_per_core_s", "evaluate_greedy_link_steps_per_core_s"):
        assert 100.0 < rest.pop(key) <= 150.0, "two missions of up to 150 decisions"
    assert rest["physics_core_min_per_100_episodes"] == pytest.approx(100 * 1500 / 480.0 / 60)
    assert rest["physics_callback_overhead"] > -0.9 and rest["physics_contacts"] > 0.0
    assert all(50.0 < rest[f"peak_memory{of}"] < 5000.0 for of in ("", "_large", "_physics"))
    assert set(measured) - set(figures) == {"physics", "learning", "memory"}
    for kind, least in (("physics_share", 0.5), ("ddqn_share", 0.999)):
        shares = [value for key, value in rest.items() if kind in key]
        assert least < sum(shares) <= 1.0 + 1e-9 and min(shares) > 0.0
    for figure in figures.values():
        assert figure["unit"]
        assert ("quickest" in figure) == ("per CPU second" in str(figure["unit"]))


def test_environments_are_measured_in_batches_of_two_sizes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speeds, "_env_steps", lambda size, **_: (rates.Rate(size, size), 4))
    found = {name: rate.median for name, rate in speeds._environment_speeds().items()}
    assert found["env_steps_per_core_s_uint8_reused"] == 64
    assert found["env_steps_per_core_s_uint8_reused_many"] == 256


def test_a_rate_is_the_median_of_slices_and_the_quickest(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first call, which compiles, is none of them."""
    spent = iter([*(0.0, 4.0), *(5.0, 6.0), *(7.0, 9.0)])
    monkeypatch.setattr(rates, "REPEATS", 3)
    monkeypatch.setattr("mjforage.bench.rates.time.process_time", lambda: next(spent))
    work, begun = iter([100.0, 8.0, 8.0, 8.0]), list[int]()
    found = rates.rate(lambda: next(work), lambda: begun.append(1))
    assert found == rates.Rate(median=4.0, quickest=8.0)
    assert len(begun) == 4, "every slice is of the same work"
    assert found.times(10.0) == rates.Rate(40.0, 80.0)
