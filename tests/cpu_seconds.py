"""CPU seconds of each test, its processes included, and what `make quick` and `test` leave out.

`tests/slow.txt` names the tests that take more than `BOUND_S` with all their parameters; they have
the mark `slow`. It is written by `pytest --measure`, from what that run measured: `pytest -n 2
--measure` for all, when all kernels are compiled, or whoever came first would have their time too.
Every run names tests that are not in it and took more than twice the bound, so that it does not go
stale.

Slow tests of the folders of `WHOLE` have the mark `thorough`, too: they play whole commands, runs
that are killed and go on, clusters, trainings, reports, films, missions and manoeuvres of hulls,
and take most of the time of all tests. `make test` leaves them to `make thorough`; continuous
integration runs both.

Tests of a file that imports one of `HEAVY` are slow too, whatever they do themselves: the first
import takes seconds of each process. `-m 'not slow'` loads no file that has none but slow tests.

CPU time, because wall time on a busy machine says nothing of a test; no result depends on it. The
tests of a run that ask for a fixture share its time: whoever came first would have all of it, and
when that test is left out, the next.
"""

import os
import re
from collections import Counter
from collections.abc import Generator, Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import psutil
import pytest

BOUND_S = 0.3
"""What a test may take, its parameters and fixtures counted, to be quick [CPU s]."""

HEAVY = (
    *("torch", "torchrl", "tensordict", "safetensors.torch", "stable_baselines3"),
    *("mjforage.learning.training", "mjforage.bench", "mjforage.cli.schemas"),
    *("mjforage.graph_planner.networks.inference", "mjforage.graph_planner.networks.q_network"),
    "mjforage.learning.model_policy",
)
"""Modules that take seconds to load, and ours that load them."""

WHOLE = (
    *("tests/documents", "tests/mjforage/bench", "tests/mjforage/cli", "tests/mjforage/learning"),
    *("tests/mjforage/physics/dynamics", "tests/mjforage/physics/validation"),
    *("tests/mjforage/runs", "tests/mjforage/testing", "tests/mjforage/view"),
)
"""Folders whose slow tests are left to `make thorough`."""

_IMPORTS = re.compile(rf"^(?:from|import) (?:{'|'.join(map(re.escape, HEAVY))})\b", re.MULTILINE)
_TESTS = re.compile(r"^ *def (test_\w+)\(", re.MULTILINE)

LIST = Path(__file__).with_name("slow.txt")
HEAD = f"""# Tests above {BOUND_S} CPU seconds, which `make quick` leaves out.
# Written by `pytest --measure`, which mends what it runs: tests of a file, all their parameters.
"""
MEASURED, MADE, ASKED = "cpu_s", "fixture_cpu_s", "fixtures"
"""Properties of a report: time of the call, of each fixture made for it, and all it has."""

NEW = pytest.StashKey[list[tuple[str, float]]]()
"""Fixtures made since the last test was called, with their times."""


def name_of(nodeid: str) -> str:
    """Return a test's name without its parameters."""
    return nodeid.partition("[")[0]


def listed() -> frozenset[str]:
    """Return the names of slow tests."""
    names, file = set(), ""
    for line in LIST.read_text("utf-8").splitlines() if LIST.exists() else []:
        if line.startswith(" "):
            names.add(f"{file}::{line.strip()}")
        else:
            file = line
    return frozenset(names)


def text_of(names: Iterable[str]) -> str:
    """Return the list's text."""
    tests: dict[str, list[str]] = {}
    for name in sorted(names):
        file, _, test = name.partition("::")
        tests.setdefault(file, []).append(f" {test}\n")
    return HEAD + "".join(f"{file}\n{''.join(below)}" for file, below in tests.items())


def renewed(before: Iterable[str], measured: Mapping[str, float]) -> list[str]:
    """Return the list after a run.

    Parameters
    ----------
    before : names of slow tests until now
    measured : name -> what the tests of that name took [CPU s]; others keep their place
    """
    kept = {name for name in before if name not in measured and stands(name)}
    return sorted(kept | {name for name, spent in measured.items() if spent > BOUND_S})


def stands(name: str) -> bool:
    """Whether there is a test of that name, by the text of its file."""
    path, _, function = name.partition("::")
    file = LIST.parent.parent / path
    function = function.rpartition("::")[2] or function
    return file.is_file() and bool(
        re.search(rf"^\s*def {function}\(", file.read_text("utf-8"), re.MULTILINE)
    )


def is_heavy(path: Path) -> bool:
    """Whether a file of tests loads what takes seconds, by its text."""
    return _IMPORTS.search(path.read_text("utf-8")) is not None


def is_whole(name: str) -> bool:
    """Whether a test is in one of the folders of `WHOLE`."""
    return name.startswith(tuple(f"{folder}/" for folder in WHOLE))


def has_quick_tests(path: Path, name: str) -> bool:
    """Whether a test file of that name in the list has tests that are not slow, by its text."""
    slow = {one.rpartition("::")[2] for one in listed() if one.startswith(f"{name}::")}
    return not is_heavy(path) and not set(_TESTS.findall(path.read_text("utf-8"))) <= slow


def processes_below(pid: int) -> Iterator[int]:
    """Give the processes that one has started, and those that they have, as Linux lists them."""
    with suppress(OSError):  # it has ended
        for task in Path(f"/proc/{pid}/task").iterdir():
            for child in map(int, (task / "children").read_text("ascii").split()):
                yield child
                yield from processes_below(child)


def spent_s() -> float:
    """Return the CPU time of this process, of its children and of those that ended [s].

    It is asked for several times in a test, so it looks at no process of others, as psutil does.
    """
    total = sum(os.times()[:4])  # user, system, and of children that ended
    for pid in processes_below(os.getpid()):
        try:
            total += sum(psutil.Process(pid).cpu_times()[:4])
        except psutil.NoSuchProcess:
            continue
    return total


def pytest_addoption(parser: pytest.Parser) -> None:
    """Take the option `--measure`."""
    parser.addoption("--measure", action="store_true", help=f"renew tests/{LIST.name}")


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Leave out files of which `-m 'not slow'` would leave out everything, before they load."""
    if config.option.markexpr != "not slow" or not collection_path.match("test_*.py"):
        return None
    name = collection_path.relative_to(config.rootpath).as_posix()
    return None if has_quick_tests(collection_path, name) else True


@pytest.hookimpl(tryfirst=True)  # before `-m` chooses
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what the list names as `slow` or `thorough`, tests of heavy files as `slow`."""
    slow = listed()
    heavy = {path for path in {item.path for item in items} if is_heavy(path)}
    for item in items:
        name = name_of(item.nodeid)
        if name in slow or item.path in heavy:
            item.add_marker("slow")
        if name in slow and is_whole(name):
            item.add_marker("thorough")


def _name_of_fixture(fixture: pytest.FixtureDef[Any]) -> str:
    return f"{fixture.baseid}::{fixture.argname}"


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(
    fixturedef: pytest.FixtureDef[Any], request: pytest.FixtureRequest
) -> Generator[None, object, object]:
    """Take the time of a fixture, less of those that it asks for."""
    before = spent_s()
    made = yield
    request.session.stash.setdefault(NEW, []).append(
        (_name_of_fixture(fixturedef), spent_s() - before)
    )
    return made


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    """Take the time of the test, and note which fixtures were made for it, and which it has."""
    before = spent_s()
    try:
        yield
    finally:
        item.user_properties.append((MEASURED, spent_s() - before))
        item.user_properties.append((MADE, item.session.stash.get(NEW, [])))
        item.session.stash[NEW] = []
        known = getattr(item, "_fixtureinfo", None)
        found = known.name2fixturedefs.values() if known else ()
        item.user_properties.append((ASKED, [_name_of_fixture(one[-1]) for one in found]))


def spent_by_test(properties: Iterable[tuple[str, Mapping[str, Any]]]) -> dict[str, float]:
    """Return the time of each test with all its parameters, shares of fixtures included.

    Parameters
    ----------
    properties : node and properties of each report, several for the parameters of a test

    Returns
    -------
    name without parameters -> what the tests of that name took together [CPU s]
    """
    told = [(name_of(node), known) for node, known in properties if MEASURED in known]
    made: Counter[str] = Counter()
    for _, known in told:
        for fixture, spent in known[MADE]:
            made[fixture] += spent
    users = Counter(fixture for _, known in told for fixture in known[ASKED])
    together: dict[str, float] = {}
    for name, known in told:
        shares = sum(made[fixture] / users[fixture] for fixture in known[ASKED])
        together[name] = together.get(name, 0.0) + known[MEASURED] + shares
    return together


def pytest_terminal_summary(
    terminalreporter: pytest.TerminalReporter, config: pytest.Config
) -> None:
    """Renew the list if asked to, and name what is far above the bound and not in it."""
    reports = (one for kind in terminalreporter.stats.values() for one in kind)
    measured = spent_by_test(
        (one.nodeid, dict(one.user_properties))
        for one in reports
        if getattr(one, "when", None) == "call"
    )
    if config.getoption("--measure"):
        LIST.write_text(text_of(renewed(listed(), measured)), "utf-8")
    slow = listed()
    late = {n: spent for n, spent in measured.items() if n not in slow and spent > 2 * BOUND_S}
    if late:
        terminalreporter.section(f"not in tests/{LIST.name} (pytest --measure mends it)")
    for name, spent in sorted(late.items(), key=lambda item: -item[1])[:30]:
        terminalreporter.write_line(f"{spent:6.1f} CPU s  {name}")
