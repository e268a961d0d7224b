from functools import partial

import numpy as np

from mjforage.bench.memory import peak_memory_mb


def fill(megabytes: int) -> None:
    """Use so much memory."""
    np.ones(megabytes * 131_072)  # of 8 bytes


def test_peak_is_that_of_the_work_alone() -> None:
    """What this process has used before does not count."""
    fill(600)
    little, more = peak_memory_mb(partial(fill, 1)), peak_memory_mb(partial(fill, 200))
    assert little < 500.0
    assert abs(more - little - 199.0) < 20.0
