"""How fast missions run in MuJoCo, and where their time goes; for `mjforage bench`."""

import cProfile
import pstats

import numpy as np

from mjforage.bench.rates import Rate, rate
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.mission_metrics import Scorer
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario_file import load_scenario

PARTS = {
    "stepping": ("simulation.py", "step"),
    "control": ("pilot.py", "command"),
    "weather": ("mujoco_dynamics.py", "_feel"),
    "watching": ("mujoco_dynamics.py", "_note"),
    "policy": ("greedy.py", "act"),
    "seeing": ("mission.py", "_see"),
    "logging": ("scoring.py", "see"),
}
"""Part -> file and function whose time it is, callees included."""


def mission_speeds(episodes: int = 10, horizon: int = 150) -> dict[str, float | Rate]:
    """Measure Greedy on the default scenario.

    Parameters
    ----------
    episodes : in one batch
    horizon : decisions

    Returns
    -------
    dict
        ``physics_mission_sim_s_per_core_s``: simulated seconds per CPU second, all that a logged
        mission does; ``physics_core_min_per_100_episodes`` of 1500 s each;
        ``physics_share_PART``: of the time of a second, profiled run.
    """
    setup = Setup.of(load_scenario("comb-port", [f"horizon={horizon}"]))
    speed = rate(lambda: _play(setup, episodes))
    profile = cProfile.Profile()
    profile.runcall(_play, setup, episodes)
    figures: dict[str, float | Rate] = {
        "physics_mission_sim_s_per_core_s": speed,
        "physics_core_min_per_100_episodes": 100 * 1500.0 / speed.median / 60.0,
    }
    return figures | _shares(profile)


def _play(setup: Setup, episodes: int) -> float:
    """Simulated time of all episodes [s]."""
    mission = create_mission(setup, "physics")
    mission.reset(0, np.arange(episodes))
    scorer = Scorer(mission)
    mission.run(create_policy("greedy"), (scorer,))
    return float(scorer.log.length.sum()) * setup.scenario.period_s


def _shares(profile: cProfile.Profile) -> dict[str, float]:
    stats = pstats.Stats(profile)
    total = stats.total_tt  # type: ignore[attr-defined]
    shares = dict.fromkeys((f"physics_share_{part}" for part in PARTS), 0.0)
    for (path, _, name), entry in stats.stats.items():  # type: ignore[attr-defined]
        for part, place in PARTS.items():
            if (path.rsplit("/", 1)[-1], name) == place:
                shares[f"physics_share_{part}"] += entry[3] / total
    return shares
