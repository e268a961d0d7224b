"""Random but valid event tables for the property tests."""

from collections.abc import Callable

import numpy as np
import pytest

from mjforage.metrics import EventTable

HORIZON = 30
AGENTS = 5


@pytest.fixture(scope="session")
def random_events() -> Callable[..., EventTable]:
    def build(seed: int, episodes: int = 3, items: int = 12) -> EventTable:
        rng = np.random.default_rng(seed)
        shape = (episodes, items)
        exists = rng.random(shape) < 0.9
        found = exists & (rng.random(shape) < 0.8)
        taken = found & (rng.random(shape) < 0.7)
        start = rng.integers(0, HORIZON + 1, shape)
        end = np.minimum(start + rng.integers(0, 12, shape), HORIZON)
        return EventTable(
            np.where(found, start, np.nan),
            np.where(found, rng.integers(0, AGENTS, shape), -1),
            np.where(taken, end, np.nan),
            np.where(taken, rng.integers(0, AGENTS, shape), -1),
            exists,
        )

    return build
