from collections.abc import Sequence
from functools import partial

import pytest

from mjforage.bench import learning as speeds
from mjforage.bench import rates, simulations
from mjforage.bench import running as bench
from mjforage.core.scenario import Scenario
from mjforage.core.scenario_file import load_scenario

HORIZON = "horizon=10"  # where the bench asks for no other


def short(name: str, overrides: Sequence[str] = ()) -> Scenario:
    return load_scenario(name, (HORIZON, *overrides))


def test_bench_measures_every_promised_figure(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a tiny load: the figures are there, positive, and have units."""
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
    promised = {
        *(f"graph_{name}_steps_per_core_s" for name in ("random", "greedy", "levy")),
        *("graph_belief_steps_per_core_s", "graph_belief_fast_steps_per_core_s"),
        *(f"belief_decisions_{agents}_agents_per_core_s" for agents in (4, 6)),
        *(f"{name}_decisions_6_holders_per_core_s" for name in ("greedy", "belief")),
        *(f"graph_greedy_{name}_steps_per_core_s" for name in ("link", "misses")),
        *(f"graph_belief_{name}_steps_per_core_s" for name in ("link", "misses")),
        "evaluate_greedy_link_steps_per_core_s",
        *("evaluate_greedy_steps_per_core_s", "metrics_episodes_per_s"),
        *("peak_memory", "peak_memory_large", "peak_memory_physics"),
        *("physics_steps_per_core_s", "physics_sim_s_per_core_s", "physics_callback_overhead"),
        *("physics_mission_sim_s_per_core_s", "physics_core_min_per_100_episodes"),
        *(f"env_obs_steps_per_core_s_{kind}" for kind in ("egocentric", "paper")),
        *(f"env_steps_per_core_s_{name}" for name in ("float32", "uint8", "uint8_reused")),
        *("env_steps_per_core_s_uint8_reused_many", "env_frames_per_core_s"),
        *("ddqn_updates_per_s", "ddqn_share_environment", "ddqn_share_network"),
        *(f"physics_share_{part}" for part in ("stepping", "control", "weather", "watching")),
    }
    assert promised <= set(figures)
    assert set(measured) - set(figures) == {"physics", "learning", "memory"}
    for kind, least in (("physics_share", 0.5), ("ddqn_share", 0.999)):
        shares = [float(figure["value"]) for key, figure in figures.items() if kind in key]
        assert least < sum(shares) <= 1.0 + 1e-9
    for key, figure in figures.items():
        assert figure["unit"]
        assert float(figure["value"]) > (-0.9 if "overhead" in key else 0.0), key
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
