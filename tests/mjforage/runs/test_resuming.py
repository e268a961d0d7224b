"""Runs that are killed, interrupted or out of disk: one clear error, and nothing lost."""

import contextlib
import json
import os
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mjforage.base.errors import UserError
from mjforage.mission.setup import Setup
from mjforage.runs import layout
from mjforage.runs.costs import load_costs
from mjforage.runs.evaluate import evaluate
from mjforage.runs.jobs import Job, run_chunk
from mjforage.runs.layout import CHUNK, plan
from mjforage.runs.lock import folder_lock
from mjforage.runs.storage import Chunk, RunFolder
from mjforage.runs.tables import TABLES
from mjforage.scenario.scenario_file import load_scenario

PATIENCE_S = 120.0
Start = Callable[..., "subprocess.Popen[str]"]
INTERRUPTED = (
    "mjforage: interrupted; a run, study or training goes on when the same command is given again\n"
)
TELL_CHUNKS = """
import json
from mjforage.runs.storage import RunFolder
from mjforage.runs import evaluate
carried_out, merge = evaluate.carried_out, RunFolder.merge
def tell_missing(call, work, workers):
    if call is evaluate.run_chunk:
        print(json.dumps([chunk.name for _, chunk in work]))
    return carried_out(call, work, workers)
def tell_finished(run, chunks):
    print(json.dumps({p.name: p.stat().st_ino for p in (run.path / "chunks").glob("[gp]*-*")}))
    merge(run, chunks)
evaluate.carried_out, RunFolder.merge = tell_missing, tell_finished
"""
NO_REPORT = """
import mjforage.view.report
mjforage.view.report.write_report = lambda folder, *_: folder / "report.html"
"""
"""Its seconds in every process prove nothing here; tests of the report draw it."""
LIMIT = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, ({0}, {0}))"
needs_proc = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="needs /proc")


HORIZON = {"graph": 100, "physics": 6}


def arguments(folder: Path, episodes: int, jobs: int) -> tuple[object, ...]:
    return (
        *("evaluate", "comb-port", "--policy", "greedy", "--seed", 3),
        *("--set", f"horizon={HORIZON['graph']}"),
        *("--episodes", episodes, "--jobs", jobs, "--out", folder),
    )


def wait_for(condition: Callable[[], object], what: str) -> None:
    end = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end, f"waited in vain for {what}"
        time.sleep(0.005)


def chunks(folder: Path) -> dict[str, int]:
    """Finished chunks and the inode of each."""
    return {path.name: path.stat().st_ino for path in (folder / "chunks").glob("[gp]*-*")}


def children(pid: int) -> dict[int, str]:
    """Living processes started by one, with their command lines."""
    found = {}
    for path in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            fields = (path / "stat").read_text().rpartition(")")[2].split()
            if fields[0] != "Z" and int(fields[1]) == pid:
                found[int(path.name)] = (path / "cmdline").read_text()
    return found


def workers(pid: int) -> set[int]:
    return {child for child, line in children(pid).items() if "popen_loky" in line}


def alive(pid: int) -> bool:
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    return False


@pytest.fixture(scope="module", autouse=True)
def compiled(finished: Path) -> None:
    """Compile all kernels, so that no process waits for that or writes caches on a full disk."""
    assert finished.is_dir()
    assert Setup.of(load_scenario("comb-port")).reachable_shares["scouts"] == 1.0


def undisturbed(folder: Path, episodes: int, world: str = "graph") -> Path:
    setup = Setup.of(load_scenario("comb-port", [f"horizon={HORIZON[world]}"]))
    evaluate(setup, ["greedy"], folder, episodes=episodes, seed=3, worlds=(world,))
    return folder


@needs_proc
def test_a_killed_run_resumes_to_the_same_bytes(start: Start, tmp_path: Path) -> None:
    """Chunks enough, and long enough, that some are left: workers go on with what is queued."""
    run, episodes = tmp_path / "run", 500
    everything = len(plan(["greedy"], ["graph"], episodes))
    killed = start(*arguments(run, episodes, 2))
    wait_for(lambda: chunks(run), "a finished chunk")
    wait_for(lambda: len(workers(killed.pid)) == 2, "two workers")
    helpers = children(killed.pid)
    os.kill(killed.pid, signal.SIGKILL)
    killed.wait(PATIENCE_S)
    wait_for(lambda: not any(alive(pid) for pid in helpers), "the end of the workers")
    kept = chunks(run)
    assert 1 <= len(kept) < everything
    assert not (run / "summary.json").exists()
    resumed = start(*arguments(run, episodes, 2), before=NO_REPORT + TELL_CHUNKS)
    out, err = resumed.communicate(timeout=PATIENCE_S)
    assert (resumed.returncode, err) == (0, "")
    computed, merged = (json.loads(line) for line in out.splitlines()[1:3])
    assert set(computed) == set(merged) - set(kept), "finished chunks were computed again"
    assert len(merged) == everything
    assert kept.items() <= merged.items(), "finished chunks were written again"
    assert not (run / "chunks").exists()
    assert_same(run, undisturbed(tmp_path / "whole", episodes))


def assert_same(run: Path, whole: Path) -> None:
    for name in ("summary.json", *(f"{table}.parquet" for table in TABLES)):
        assert (run / name).read_bytes() == (whole / name).read_bytes(), name


@pytest.mark.parametrize(("world", "episodes"), [("graph", CHUNK + 5), ("physics", 15)])
def test_a_stopped_run_goes_on_to_the_same_bytes(tmp_path: Path, world: str, episodes: int) -> None:
    run = tmp_path / "run"
    stop_after_one_chunk(run, episodes, world)
    assert len(chunks(run)) == 1
    assert_same(undisturbed(run, episodes, world), undisturbed(tmp_path / "w", episodes, world))


@pytest.mark.parametrize("jobs", [1, 2])
def test_ctrl_c_is_one_line_and_keeps_finished_chunks(
    jobs: int, start: Start, tmp_path: Path
) -> None:
    run = tmp_path / "run"
    process = start(*arguments(run, 5000, jobs))
    wait_for(lambda: chunks(run), "a finished chunk")
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, err) == (130, INTERRUPTED)
    assert 1 <= len(chunks(run)) < 200
    run_folder = RunFolder(run)
    finished = [chunk for chunk in plan(["greedy"], ["graph"], 5000) if run_folder.has(chunk)]
    assert len(finished) == len(chunks(run))


@needs_proc
def test_ctrl_c_while_workers_start_is_one_line(start: Start, tmp_path: Path) -> None:
    process = start(*arguments(tmp_path / "run", 5000, 2))
    wait_for(lambda: workers(process.pid), "a worker")
    helpers = children(process.pid)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, err) == (130, INTERRUPTED)
    wait_for(lambda: not any(alive(pid) for pid in helpers), "the end of the workers")


@needs_proc
def test_a_run_that_is_killed_with_all_its_helpers_leaves_no_folder_for_arrays(
    start: Start, tmp_path: Path
) -> None:
    """Not even joblib's own helper is left to remove it."""
    process = start(*arguments(tmp_path / "run", 5000, 2))
    wait_for(lambda: chunks(tmp_path / "run"), "a finished chunk")
    os.killpg(process.pid, signal.SIGKILL)
    process.wait(PATIENCE_S)
    places = (Path("/dev/shm"), Path(tempfile.gettempdir()), Path.cwd())
    left = [path for place in places for path in place.glob(f"joblib_memm*_{process.pid}_*")]
    assert left == []


@needs_proc
def test_a_killed_worker_is_one_line(start: Start, tmp_path: Path) -> None:
    process = start(*arguments(tmp_path / "run", 5000, 2))
    wait_for(lambda: chunks(tmp_path / "run"), "a finished chunk")
    os.kill(workers(process.pid).pop(), signal.SIGKILL)
    _, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 2
    assert err.startswith("mjforage: a worker process was killed, perhaps for want of memory")
    assert err.count("\n") == 1
    assert chunks(tmp_path / "run")


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_full_disk_is_one_line_and_keeps_finished_chunks(
    jobs: int, start: Start, tmp_path: Path
) -> None:
    pytest.importorskip("resource")
    run, episodes = tmp_path / "run", 100
    stop_after_one_chunk(run, episodes)
    kept = chunks(run)
    assert len(kept) == 1
    process = start(*arguments(run, episodes, jobs), before=LIMIT.format(20_000))
    _, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 2
    assert "cannot be written (File too large); free some space there" in err
    assert err.count("\n") == 1
    assert chunks(run) == kept
    assert [path.name for path in (run / "chunks").glob("[!.]*")] == list(kept)
    undisturbed(run, episodes)
    assert not (run / "chunks").exists()
    whole = undisturbed(tmp_path / "whole", episodes)
    assert (run / "summary.json").read_bytes() == (whole / "summary.json").read_bytes()


def test_a_disk_that_fills_while_merging_keeps_every_chunk(start: Start, tmp_path: Path) -> None:
    pytest.importorskip("resource")
    run, episodes = tmp_path / "run", 500
    process = start(*arguments(run, episodes, 1), before=LIMIT.format(300_000))
    _, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 2
    assert err.startswith(f"mjforage: {run}/")
    assert "parquet: cannot be written (" in err
    assert err.count("\n") == 1
    assert len(chunks(run)) == 500 / CHUNK
    assert not (run / "summary.json").exists()
    assert [path.name for path in run.glob(".*")] == [".lock"]


def stop_after_one_chunk(folder: Path, episodes: int, world: str = "graph") -> None:
    def stop(done: int, _: int) -> None:
        if done:
            raise KeyboardInterrupt

    setup = Setup.of(load_scenario("comb-port", [f"horizon={HORIZON[world]}"]))
    with contextlib.suppress(KeyboardInterrupt):
        evaluate(
            setup, ["greedy"], folder, episodes=episodes, seed=3, worlds=(world,), progress=stop
        )


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, int, int]]:
    """Policy, first episode and number of the chunks that are computed, two episodes at most."""
    found: list[tuple[str, int, int]] = []

    def note(job: Job, chunk: Chunk) -> str | None:
        found.append((chunk.policy, chunk.first, chunk.count))
        return run_chunk(job, chunk)

    monkeypatch.setattr("mjforage.runs.evaluate.run_chunk", note)
    monkeypatch.setattr(layout, "CHUNK", 2)
    return found


def of_episodes(folder: Path, episodes: int, **options: Any) -> Path:
    setup = Setup.of(load_scenario("comb-port", ["horizon=5"]))
    evaluate(setup, ["levy", "greedy"], folder, episodes=episodes, **options)
    return folder


def assert_equal(run: Path, whole: Path) -> None:
    """The same tables to the bit, in files that may be divided otherwise."""
    assert (run / "summary.json").read_bytes() == (whole / "summary.json").read_bytes()
    for name in TABLES:
        one, other = RunFolder(run).table(name), RunFolder(whole).table(name)
        assert one.equals(other) and one.schema == other.schema, name
    assert not (run / "chunks").exists()


def test_a_finished_run_goes_on_to_more_episodes(
    asked: list[tuple[str, int, int]], tmp_path: Path
) -> None:
    run, whole = of_episodes(tmp_path / "run", 3), of_episodes(tmp_path / "whole", 6)
    asked.clear()
    of_episodes(run, 6)
    assert asked == [("levy", 3, 1), ("levy", 4, 2), ("greedy", 3, 1), ("greedy", 4, 2)]
    assert_equal(run, whole)
    info = json.loads((run / "run.json").read_text())
    assert info["episodes"] == 6
    counted = [(one.policy, one.episodes) for one in load_costs(run / "costs.json")]
    assert counted == [(name, n) for name in ("levy", "greedy") for n in (2, 1, 1, 2)]
    asked.clear()
    of_episodes(run, 6)
    assert asked == []
    with pytest.raises(UserError, match="episodes is 6 there and 3 here, and a run goes on to"):
        of_episodes(run, 3)


def test_a_stopped_run_goes_on_to_more_episodes(
    asked: list[tuple[str, int, int]], tmp_path: Path
) -> None:
    def stop(done: int, _: int) -> None:
        if done > 3:
            raise KeyboardInterrupt

    run = tmp_path / "run"
    with contextlib.suppress(KeyboardInterrupt):
        of_episodes(run, 3, progress=stop)
    assert asked == [("levy", 0, 2), ("levy", 2, 1), ("greedy", 0, 2)]
    asked.clear()
    of_episodes(run, 5)
    assert asked == [("levy", 3, 1), ("levy", 4, 1), ("greedy", 2, 2), ("greedy", 4, 1)]
    assert_equal(run, of_episodes(tmp_path / "whole", 5))


@pytest.mark.parametrize("moment", [1, 3])
def test_a_run_killed_while_it_goes_on_to_more_loses_nothing(
    asked: list[tuple[str, int, int]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, moment: int
) -> None:
    """As its tables become chunks again, of which some are whole."""
    run, write, left = of_episodes(tmp_path / "run", 3), RunFolder.write, iter(range(9))

    def killed(*words: Any) -> None:
        if next(left) == moment:
            raise KeyboardInterrupt
        write(*words)

    with monkeypatch.context() as during, contextlib.suppress(KeyboardInterrupt):
        during.setattr(RunFolder, "write", killed)
        of_episodes(run, 4)
    assert len(list((run / "chunks").iterdir())) == moment
    assert not (run / "summary.json").exists()
    asked.clear()
    of_episodes(run, 4)
    assert asked == [("levy", 3, 1), ("greedy", 3, 1)]
    assert_equal(run, of_episodes(tmp_path / "whole", 4))


def test_nobody_goes_on_to_more_of_a_run_that_is_being_written(tmp_path: Path) -> None:
    run = of_episodes(tmp_path / "run", 1)
    with folder_lock(run), pytest.raises(UserError, match="another process is writing this run"):
        of_episodes(run, 2)
    assert of_episodes(run, 1) and (run / "summary.json").exists()


DIE_AT = """
import os, shutil, signal, sys
from pathlib import Path
calls = 0
def dying(inner):
    def call(*arguments, **options):
        global calls
        calls += 1
        if calls == {moment}:
            os.kill(os.getpid(), signal.SIGKILL)
        return inner(*arguments, **options)
    return call
for owner, name in ((Path, "replace"), (Path, "rename"), (Path, "rmdir"), (shutil, "rmtree")):
    setattr(owner, name, dying(getattr(owner, name)))
"""


@pytest.mark.parametrize("moment", [6, 12])
def test_a_run_killed_while_it_finishes_ends_the_same(
    start: Start, tmp_path: Path, moment: int
) -> None:
    """Killed at a renaming or a removal: between two tables, and when only chunks are left over."""
    run = tmp_path / "run"
    asked = ("evaluate", "comb-port", "--policy", "greedy", "--set", "horizon=5", "--episodes", 3)
    killed = start(*asked, "--out", run, before=NO_REPORT + DIE_AT.format(moment=moment))
    killed.communicate(timeout=PATIENCE_S)
    assert killed.returncode == -signal.SIGKILL
    resumed = start(*asked, "--out", run, before=NO_REPORT)
    _, err = resumed.communicate(timeout=PATIENCE_S)
    assert (resumed.returncode, err) == (0, "")
    whole = tmp_path / "whole"
    setup = Setup.of(load_scenario("comb-port", ["horizon=5"]))
    evaluate(setup, ["greedy"], whole, episodes=3)
    assert_same(run, whole)
    assert not (run / "chunks").exists()
    assert not list(run.glob(".*.*"))
