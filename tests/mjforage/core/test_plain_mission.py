"""The kernels' mission against the one in plain Python, state by state."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as how
from hypothesis import strategies as st

from mjforage.core.mission import Mission
from mjforage.core.mission_metrics import Scorer
from mjforage.core.scenario_file import load_scenario
from mjforage.core.setup import Setup
from tests.mjforage.core.agreeing import SlowScores, play, score_alike
from tests.mjforage.core.random_scenarios import setups
from tests.mjforage.core.slow_mission import SlowMission


def compared(setup: Setup, seed: int, episodes: int = 2) -> list[SlowMission]:
    """Play both, compare every state and all scores; what the plain ones came to."""
    mission, slow = Mission(setup), [SlowMission(setup, seed, e) for e in range(episodes)]
    mission.reset(seed, np.arange(episodes))
    scorer, scores = Scorer(mission), [SlowScores(oracle) for oracle in slow]

    def see(mission: Mission) -> None:
        scorer.see(mission)
        for one in scores:
            if len(one.courses["mi"]) <= one.oracle.step:
                one.see()

    play(mission, slow, seed, see)
    score_alike(scorer, scores)
    return slow


@given(setup=setups(), seed=st.integers(0, 99))
@how(max_examples=60)
def test_kernels_agree_on_random_scenarios(setup: Setup, seed: int) -> None:
    compared(setup, seed)
