"""The list of slow tests: names that are there, and what a run does to it."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests import cpu_seconds
from tests.cpu_seconds import (
    ASKED,
    BOUND_S,
    LIST,
    MADE,
    MEASURED,
    WHOLE,
    has_quick_tests,
    listed,
    renewed,
    spent_by_test,
    spent_s,
    stands,
)

HERE = "tests/test_cpu_seconds.py"
MINE = f"{HERE}::test_every_name_is_of_a_test"
OTHER = f"{HERE}::test_a_run_mends_what_it_ran"

pytest_plugins = ["pytester"]


def test_every_name_is_of_a_test() -> None:
    assert [name for name in listed() if not stands(name)] == []
    assert listed() == frozenset(renewed(listed(), {})), "the list is sorted and whole"


def test_slow_tests_of_whole_runs_are_thorough_and_no_others(
    request: pytest.FixtureRequest,
) -> None:
    assert all((LIST.parent.parent / folder).is_dir() for folder in WHOLE)
    for item in request.session.items:
        name = item.nodeid.partition("[")[0]
        whole = name in listed() and name.startswith(tuple(f"{folder}/" for folder in WHOLE))
        assert (item.get_closest_marker("thorough") is not None) == whole, name


def test_names_that_are_none_do_not_stand() -> None:
    assert stands(MINE)
    assert not stands(f"{HERE}::test_every_name")
    assert not stands("tests/test_none.py::test_every_name_is_of_a_test")


def test_a_run_mends_what_it_ran() -> None:
    gone = f"{HERE}::test_that_was_renamed"
    assert renewed([MINE, gone], {}) == [MINE]
    assert renewed([MINE], {MINE: BOUND_S, OTHER: 2 * BOUND_S}) == [OTHER]
    assert renewed([MINE], {OTHER: 0.0}) == [MINE]


def test_time_of_processes_that_run_and_have_ended_counts() -> None:
    burn = "import time\nwhile time.process_time() < 0.2: pass\nprint(flush=True)\ninput()"
    before = spent_s()
    with subprocess.Popen(
        [sys.executable, "-c", burn], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()
        assert spent_s() - before >= 0.15  # in ticks of 10 ms
        process.communicate("\n")
    assert spent_s() - before >= 0.15  # in ticks of 10 ms


def test_tests_share_the_time_of_a_fixture_whoever_came_first() -> None:
    reports: list[tuple[str, dict[str, Any]]] = [
        ("a.py::test_one", {MEASURED: 1.0, MADE: [("run", 3.0), ("folder", 0.5)], ASKED: ["run"]}),
        ("a.py::test_two[x]", {MEASURED: 0.5, MADE: [], ASKED: ["run", "unmade"]}),
        ("a.py::test_two[y]", {MEASURED: 0.1, MADE: [("run", 3.0)], ASKED: ["run"]}),
        ("a.py::test_three", {MEASURED: 0.1, MADE: [], ASKED: []}),
        ("a.py::test_skipped", {}),
    ]
    assert spent_by_test(reports) == {
        "a.py::test_one": 3.0,
        "a.py::test_two": 4.6,
        "a.py::test_three": 0.1,
    }


def test_a_listed_test_is_left_out_and_an_unlisted_one_named(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    held = tmp_path / LIST.name
    held.write_text("# head\ntest_made.py\n test_slow\n")
    monkeypatch.setattr(cpu_seconds, "LIST", held)
    monkeypatch.setattr(cpu_seconds, "BOUND_S", -1.0)
    pytester.makepyfile(
        test_made="""
        import pytest

        @pytest.mark.parametrize("n", [1, 2])
        def test_slow(n):
            pass

        def test_other():
            pass
        """
    )
    options = ("-p", "no:cacheprovider", "-W", "ignore")
    told = pytester.inline_run(*options, "-m", "not slow", plugins=[cpu_seconds])
    told.assertoutcome(passed=1)
    pytester.inline_run(*options, "--measure", plugins=[cpu_seconds])
    assert held.read_text().splitlines()[2:] == ["test_made.py", " test_other", " test_slow"]


def test_files_with_none_but_slow_tests_are_not_loaded(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    held = tmp_path / LIST.name
    held.write_text("test_all.py\n test_slow\n")
    monkeypatch.setattr(cpu_seconds, "LIST", held)
    pytester.makepyfile(
        test_all="raise AssertionError('loaded')\ndef test_slow(): pass\n",
        test_heavy="raise AssertionError('loaded')\nimport torch\ndef test_quick(): pass\n",
        test_other="def test_slow(): pass\n",
    )
    options = ("-p", "no:cacheprovider", "-W", "ignore", "-m", "not slow")
    pytester.inline_run(*options, plugins=[cpu_seconds]).assertoutcome(passed=1)
    assert not has_quick_tests(pytester.path / "test_heavy.py", "test_heavy.py")
