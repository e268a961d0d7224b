"""Missions in which a GPU, or numba's simulator of one, repeats calls of kernels; prints which.

The simulator gives the same bits, a GPU all but the last ones: each kernel is called once.
"""

import copy
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from mjforage.base.device import SIMULATED, Launch, OnDevice, names_of
from tests.mjforage.physics.dynamics.device_kernels import EPISODES, LAUNCHES, fly, watched

EVERY = 25  # calls of each kernel: those that are compared, and the first two
ROUNDING = 1e-9  # relative, of a GPU

seen: Counter[str] = Counter()


def _arrays(launch: Launch, name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Arrays of an argument, by name, without memory."""
    if isinstance(value, tuple):
        names = getattr(value, "_fields", range(len(value)))
        for field, part in zip(names, value, strict=True):
            yield from _arrays(launch, f"{name}.{field}", part)
    elif isinstance(value, np.ndarray) and not launch.is_memory(name):
        yield name, value


def _compared(name: str, given: tuple[Any, ...], call: Callable[[], Any]) -> Any:
    """Call a kernel, and launch it on a copy of its arguments as they were."""
    launch = LAUNCHES[name]
    seen[name] += 1
    if seen[name] > 2 and seen[name] % EVERY:
        return call()
    before, answer = copy.deepcopy(given), call()
    names = names_of(launch.kernel)
    if "ids" in names:
        mask, at = np.zeros(EPISODES, np.bool_), names.index("ids")
        mask[before[at]] = True
        before = (*before[:at], mask, *before[at + 1 :])
    device = OnDevice()
    launch(EPISODES, *launch.arguments(device, EPISODES, *before))
    for argument, old, new in zip(names, before, given, strict=True):
        if argument == "ids":
            continue
        found = dict(_arrays(launch, argument, old))
        for where, array in _arrays(launch, argument, new):
            assert _are_equal(device.fetch(found[where]), array), f"{name}: {where}"
    return answer


def _are_equal(found: Any, wanted: Any) -> bool:
    if SIMULATED or wanted.dtype.kind in "biu":
        return bool(found.tobytes() == wanted.tobytes())
    if wanted.dtype.names:
        return all(_are_equal(found[name], wanted[name]) for name in wanted.dtype.names)
    return np.allclose(found, wanted, ROUNDING, ROUNDING, equal_nan=True)


if __name__ == "__main__":
    with watched(_compared):
        fly()
    sys.stdout.write(" ".join(sorted(seen)))
