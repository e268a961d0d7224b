"""CPU seconds of each test, its processes included, and which tests want the mark `slow`.

CPU time, because wall time on a busy machine says nothing of a test. A fixture's time stands with
the first test that asks for it.
"""

import json
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

BOUND_S = 1.0
"""What a test may take, its fixtures counted, without the mark `slow` [CPU s]."""


def spent() -> float:
    """Return the CPU time of this process, of its children and of those that ended [s]."""
    here = psutil.Process()
    total = 0.0
    for process in (here, *here.children(recursive=True)):
        try:
            total += sum(process.cpu_times()[:4])  # user, system, and of children that ended
        except psutil.NoSuchProcess:
            continue
    return total


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item: pytest.Item) -> Iterator[None]:
    """Take the time of fixtures."""
    before = spent()
    try:
        yield
    finally:
        item.user_properties.append(("setup_s", round(spent() - before, 3)))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    """Take the time of the test."""
    before = spent()
    try:
        yield
    finally:
        item.user_properties.append(("call_s", round(spent() - before, 3)))
        item.user_properties.append(("slow", item.get_closest_marker("slow") is not None))


def pytest_addoption(parser: pytest.Parser) -> None:
    """Take the option `--cpu-seconds FILE`."""
    parser.addoption("--cpu-seconds", metavar="FILE", help="write CPU seconds of each test (JSON)")


def pytest_terminal_summary(
    terminalreporter: pytest.TerminalReporter, config: pytest.Config
) -> None:
    """Write the times, and name tests above the bound that have no mark."""
    found = {}
    for report in (report for reports in terminalreporter.stats.values() for report in reports):
        if getattr(report, "when", None) == "call":
            found[report.nodeid] = dict(report.user_properties)
    if file := config.getoption("--cpu-seconds"):
        Path(file).write_text(json.dumps(found, indent=0))
