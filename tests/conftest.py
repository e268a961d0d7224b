"""Settings of all tests, and the marks of slow ones.

Hypothesis has no deadlines (kernels compile) and is the same every time. `tests/slow.txt` names the
tests that take more than 0.3 s of CPU time with all their parameters (`pytest --durations=50`).
They have the mark `slow`, and so have all tests of a file that imports one of `HEAVY`, which takes
seconds itself. Listed tests of the folders of `WHOLE` play whole commands, trainings and reports;
they have the mark `thorough` too.
"""

import os
import re
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from hypothesis import settings

os.environ["MJFORAGE_COMPILING_SAID"] = "1"  # warnings are errors here
settings.register_profile("mjforage", deadline=None, derandomize=True)
settings.load_profile("mjforage")

SLOW = Path(__file__).with_name("slow.txt")
HEAVY = (
    *("torch", "torchrl", "tensordict", "safetensors.torch", "stable_baselines3"),
    *("mjforage.learning.training", "mjforage.bench", "mjforage.cli.schemas"),
    *("mjforage.graph_planner.networks.inference", "mjforage.graph_planner.networks.q_network"),
    "mjforage.learning.model_policy",
)
WHOLE = tuple(
    f"tests/{folder}/"
    for folder in (
        *("documents", "mjforage/bench", "mjforage/cli", "mjforage/learning"),
        *("mjforage/physics/dynamics", "mjforage/physics/validation"),
        *("mjforage/runs", "mjforage/testing", "mjforage/view"),
    )
)
_IMPORTS = re.compile(rf"^(?:from|import) (?:{'|'.join(map(re.escape, HEAVY))})\b", re.MULTILINE)


@cache
def slow_tests() -> dict[str, set[str]]:
    """File -> its tests that `slow.txt` names."""
    found: dict[str, set[str]] = {}
    file = ""
    for line in SLOW.read_text("utf-8").splitlines():
        if line.startswith(" "):
            found[file].add(line.strip())
        elif not line.startswith("#"):
            found[file := line] = set()
    return found


@cache
def _text(path: Path) -> str:
    return path.read_text("utf-8")


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Leave out files of which `-m` would leave out everything, before they load."""
    if not collection_path.match("test_*.py"):
        return None
    tests = set(re.findall(r"^def (test_\w+)\(", _text(collection_path), re.MULTILINE))
    file = collection_path.relative_to(config.rootpath).as_posix()
    listed = slow_tests().get(file, set())
    match config.option.markexpr:
        case "not slow":
            none = tests <= listed or bool(_IMPORTS.search(_text(collection_path)))
        case "thorough":
            none = not (listed and file.startswith(WHOLE))
        case _:
            return None
    return True if none else None


@pytest.hookimpl(tryfirst=True)  # before `-m` chooses
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark slow tests."""
    for item in items:
        file, _, test = item.nodeid.partition("[")[0].partition("::")
        listed = test in slow_tests().get(file, ())
        if listed or _IMPORTS.search(_text(item.path)):
            item.add_marker("slow")
        if listed and file.startswith(WHOLE):
            item.add_marker("thorough")


@pytest.fixture(autouse=True)
def own_parts_only() -> Iterator[None]:
    """Forget after each test the parts that it brought: faults of others are not theirs."""
    yield
    if loaded := sys.modules.get("mjforage.base.registry"):
        loaded._BROUGHT.clear()
