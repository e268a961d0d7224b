"""A mission has the same bits whatever instructions BLAS and numpy use on a processor."""

import hashlib
import os
import subprocess
import sys
from typing import Any, Literal

import numpy as np

import mjforage as mf

CONFIG: Any = np.show_config(mode="dicts")
EXTENSIONS = CONFIG["SIMD Extensions"].get("found", [])  # beyond the least that numpy needs
OLDEST = {"OPENBLAS_CORETYPE": "Nehalem", "NPY_DISABLE_CPU_FEATURES": " ".join(EXTENSIONS)}
PLAYED: tuple[tuple[str, Literal["graph", "physics"], str], ...] = (
    ("comb-port-weather", "physics", "belief"),
    ("comb-port-radio", "graph", "belief"),
    ("comb-port", "graph", "dec-mcts"),
)
_PROGRAM = """
from tests.mjforage.api.test_processors import digests
print(*digests())
"""


def digests(decisions: int = 20) -> list[str]:
    """SHA-256 of all states of each mission."""
    found = []
    for scenario, world, policy in PLAYED:
        mission = mf.make_mission(scenario, world=world, horizon=decisions)
        states = hashlib.sha256()
        for state in [mission.reset(seed=3), *mission.play(policy)]:
            for part in state:
                states.update(np.asarray(part).tobytes())
        found.append(states.hexdigest()[:16])
    return found


def test_missions_are_equal_to_the_bit_on_another_type_of_processor() -> None:
    words = [sys.executable, "-W", "ignore", "-c", _PROGRAM]
    other = subprocess.run(
        words, capture_output=True, text=True, check=True, env={**os.environ, **OLDEST}
    )
    assert other.stdout.split() == digests()
