"""Settings of all tests, and which of them this processor can run.

Hypothesis has no deadlines (kernels compile) and is the same every time. Tests that are marked
`every_capability` are run by `make capabilities` under each set of instructions that torch can be
told to use (`ATEN_CPU_CAPABILITY`); torch takes the word for it, and a processor without them ends
the process, so such tests are skipped there.
"""

import os
import subprocess
import sys
from collections.abc import Iterator
from functools import cache

import pytest
from hypothesis import settings

pytest_plugins = ["tests.cpu_seconds"]

settings.register_profile("mjforage", deadline=None, derandomize=True)
settings.load_profile("mjforage")

CAPABILITY = "ATEN_CPU_CAPABILITY"
RISING = ("default", "avx2", "avx512")
LACKING = "MJFORAGE_LACKS_CAPABILITY"  # why tests are skipped; processes of tests inherit it


@cache
def capability() -> str:
    """Return what torch finds on this processor when it is told nothing."""
    told_nothing = {name: value for name, value in os.environ.items() if name != CAPABILITY}
    program = "import torch; print(torch.backends.cpu.get_cpu_capability().lower())"
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=told_nothing,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip()


def pytest_configure() -> None:
    """Have torch choose for itself where this processor lacks what it is told to use.

    Some libraries compute while they are imported, which tests do before any of them is skipped.
    """
    asked = os.environ.get(CAPABILITY, RISING[0])
    if asked == RISING[0]:
        return
    found = capability()
    most = RISING.index(found) if found in RISING else 0
    if asked not in RISING[: most + 1]:
        os.environ[LACKING] = f"torch finds {found} on this processor, no {asked}"
        del os.environ[CAPABILITY]


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip what this processor cannot run, and say why."""
    why = os.environ.get(LACKING)
    if why and item.get_closest_marker("every_capability"):
        pytest.skip(why)


@pytest.fixture(autouse=True)
def own_parts_only() -> Iterator[None]:
    """Forget after each test the parts that it brought: faults of others are not theirs."""
    yield
    if loaded := sys.modules.get("mjforage.base.registry"):
        loaded._BROUGHT.clear()
