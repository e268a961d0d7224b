"""The kernels' mission against the one in plain Python, state by state."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from mjforage.mission.mission import Mission
from mjforage.mission.scoring import Scorer
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario_file import load_scenario
from tests.mjforage.mission.agreeing import SlowScores, play, score_alike
from tests.mjforage.mission.random_scenarios import Drawn, scenarios
from tests.mjforage.mission.slow_mission import SlowMission

VARIANTS = {
    "published": (),
    "published-2025": (),
    "comb-port": ("weather.wind_speed_mps=3", "weather.wind_from_deg=250"),
    "open-bay": (
        *("team.foragers.radius=1", "team.foragers.capacity=1", "weather.drift_node_per_step=0.6"),
        *("link.model=disk", "link.range_m=8", "items.covariance_node2=20"),
        *("corruption.team=foragers", "corruption.epsilon=1", "corruption.whole_team=true"),
    ),
    "channels": (
        *("team.scouts.moves=3", "team.scouts.energy=25", "team.foragers.capacity=3"),
        *("rules.walls=published", "corruption.team=scouts", "corruption.epsilon=0.5"),
    ),
}
MET = (
    *("blocked", "random action", "full", "out of energy", "out of the field of view", "missed"),
    *("overlooked beside another", "invented", "received late", "final and blocked", "shared"),
)


def compared(setup: Setup, seed: int, episodes: int = 2) -> Counter[str]:
    """Play both, compare every state and all scores; what happened in the plain ones."""
    mission, slow = Mission(setup), [SlowMission(setup, seed, e) for e in range(episodes)]
    mission.reset(seed, np.arange(episodes))
    scorer, scores = Scorer(mission), [SlowScores(oracle) for oracle in slow]

    def see(mission: Mission) -> None:
        scorer.see(mission)
        for one in scores:
            if len(one.tracks) <= one.oracle.step:
                one.see()

    play(mission, slow, seed, see)
    score_alike(scorer, scores)
    return sum((oracle.sensors.met for oracle in slow), Counter())


def test_kernels_agree_on_random_scenarios() -> None:
    """Every step of two episodes: all that agents do, know, see, receive and score."""
    met = Counter[str]()

    # The first that differs is told as it is: to make it smaller takes minutes.
    @settings(max_examples=50, phases=[Phase.generate], report_multiple_bugs=False)
    @given(drawn=scenarios(), seed=st.integers(0, 99))
    def agree(drawn: Drawn, seed: int) -> None:
        met.update(compared(drawn.setup, seed))

    agree()
    assert not [what for what in MET if met[what] < 5], met


@pytest.mark.parametrize("preset", VARIANTS)
def test_kernels_agree_on_whole_maps(preset: str) -> None:
    """Presets, one of a kind each, with more agents and steps."""
    more = ("horizon=40", "items.mean=40", "team.foragers.count=3", *VARIANTS[preset])
    compared(Setup.of(load_scenario(preset, more)), 5, episodes=1)
