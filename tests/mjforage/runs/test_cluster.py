"""dask clusters: the same bytes whatever dies, and named errors for what does not fit."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from mjforage.mission.setup import Setup
from mjforage.runs import cluster
from mjforage.runs.costs import Invocation, load_costs
from mjforage.runs.evaluate import Run
from mjforage.runs.jobs import Job, run_chunk
from mjforage.runs.layout import plan
from mjforage.runs.studies import variants
from mjforage.runs.studies.study import Study, run_study
from mjforage.runs.workers import Workers
from mjforage.scenario.scenario_file import load_scenario

pytest.importorskip("distributed")
Start = Callable[..., "subprocess.Popen[str]"]
Refused = Callable[..., str]
PATIENCE_S = 120.0
EPISODES = 150
NO_REPORT = """
from mjforage.view import report
from mjforage.view.report import studies
report.write_report = studies.write_study_report = lambda folder, *_: folder / "report.html"
"""
"""Its seconds prove nothing here; tests of reports and studies draw it."""


def wait_for(condition: Callable[[], object], what: str) -> None:
    end = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end, f"waited in vain for {what}"
        time.sleep(0.01)


def chunks(folder: Path) -> int:
    return len(list(folder.glob("variants/*/chunks/[g]*")))


def test_a_worker_killed_in_the_middle_changes_no_bit(
    start: Start, scheduler: str, tmp_path: Path
) -> None:
    setup = Setup.of(load_scenario("published", ["horizon=60"]))
    plain, killed = tmp_path / "plain", tmp_path / "killed"
    study = Study(
        "ablation",
        setup,
        variants.ablation(setup.scenario, ["greedy"]),
        episodes=EPISODES,
        options={},
    )
    run_study(study, plain)
    with cluster.connected(scheduler) as client:
        workers = list(client.run(os.getpid).values())
    process = start(
        *("study", "ablation", "published", "--policy", "greedy", "--set", "horizon=60"),
        *("--episodes", EPISODES, "--scheduler", scheduler, "--out", killed),
        before=NO_REPORT,
    )
    wait_for(lambda: chunks(killed), "a finished chunk")
    os.kill(workers[0], signal.SIGKILL)
    out, err = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, err) == (0, ""), out
    for name in ("summary.json", "variants/scouts-less/steps.parquet"):
        assert (killed / name).read_bytes() == (plain / name).read_bytes(), name
    costs = [one for path in killed.glob("variants/*/costs.json") for one in load_costs(path)]
    assert sum(cost.episodes for cost in costs) == 3 * EPISODES
    assert {(cost.workers, cost.how) for cost in costs} == {(2, f"dask at {scheduler}")}


def unused_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


def test_a_scheduler_that_does_not_answer_is_named(
    refused: Refused, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "PATIENCE_S", 0.5)
    address, folder = f"tcp://127.0.0.1:{unused_port()}", tmp_path / "study"
    words = refused("study", "ablation", "--scheduler", address, "--out", folder)
    assert words.startswith(f"mjforage: scheduler {address}: no answer within 0.5 s")
    assert "start `dask scheduler`" in words
    assert not folder.exists()


def test_another_program_at_the_address_is_named(
    refused: Refused, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "PATIENCE_S", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as mute:
        address = f"tcp://127.0.0.1:{mute.getsockname()[1]}"
        words = refused("study", "ablation", "--scheduler", address, "--out", tmp_path / "study")
    assert words.startswith(f"mjforage: scheduler {address}: no answer within 0.5 s")
    assert not (tmp_path / "study").exists()


def test_a_scheduler_without_workers_is_named(
    refused: Refused, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from distributed import LocalCluster

    monkeypatch.setattr(cluster, "PATIENCE_S", 0.5)
    with LocalCluster(n_workers=0, dashboard_address="127.0.0.1:0") as lone:  # type: ignore[no-untyped-call]
        address = lone.scheduler_address
        words = refused("study", "ablation", "--scheduler", address, "--out", tmp_path / "study")
    assert words.startswith(f"mjforage: scheduler {address}: answers, but has no worker within 0.5")
    assert f"start `dask worker {address} --nthreads 1` on every machine" in words
    assert not (tmp_path / "study").exists()


@pytest.mark.parametrize(
    "address",
    ["tcp://node7", "tcp://:8786", "tcp://node 7:8786", "node7:8786", "http://node7:1", ""],
)
def test_what_is_no_address_is_named_at_once(
    address: str, refused: Refused, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "connected", lambda *_: pytest.fail("dask was asked"))
    run = ("evaluate", "comb-port", "--policy", "greedy", "--out", tmp_path / "out")
    line = refused(*run, "--scheduler", address)
    assert line.startswith(f"mjforage: scheduler{' ' * bool(address)}{address}: ")
    assert "tcp://host:8786" in line
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("address", ["tcp://node7:8786", "tls://10.0.0.7:1", "tcp://[::1]:8786"])
def test_addresses_that_dask_prints_are_taken(address: str) -> None:
    assert Workers(scheduler=address).scheduler == address


@pytest.mark.parametrize("flags", [("--jobs", 2, "--scheduler", "tcp://a:1"), ("--jobs", 0)])
def test_workers_are_counted_once(flags: tuple[object, ...], refused: Refused) -> None:
    words = refused("evaluate", "comb-port", "--policy", "greedy", *flags)
    assert "give one of them" in words or "jobs 0: give 1 or more" in words


@pytest.fixture
def job(tmp_path: Path) -> Job:
    """Return a job as the workers of a cluster get it."""
    setup = Setup.of(load_scenario("published", ["horizon=5"]))
    run = Run.plan(setup, ["greedy"], tmp_path / "run", episodes=2)
    run.open()
    invocation = Invocation("now", "dask", 1)
    workers = Workers(scheduler="tcp://host:8786")
    return Job.of(run.setup, run.folder.path, run.info, (), invocation, workers)


def refusal(job: Job) -> str:
    chunk = plan(["greedy"], ["graph"], 2)[0]
    return str(run_chunk(job, chunk))


def test_workers_that_agree_compute(job: Job) -> None:
    assert refusal(job) == "None"
    assert {"numpy", "python", "mjforage"} <= set(dict(job.code))


@pytest.mark.parametrize("name", ["mjforage", "numpy"])
def test_a_worker_of_another_version_is_named(job: Job, name: str) -> None:
    others = tuple((key, "99" if key == name else value) for key, value in job.code)
    words = refusal(replace(job, code=others))
    assert words.startswith(f"worker on {socket.gethostname()}: {name} is ")
    assert "but 99 where the run was started" in words


def test_a_worker_of_several_threads_is_named(job: Job, monkeypatch: pytest.MonkeyPatch) -> None:
    worker = SimpleNamespace(state=SimpleNamespace(nthreads=4))
    monkeypatch.setattr("distributed.get_worker", lambda: worker)
    words = refusal(job)
    assert words.startswith(f"worker on {socket.gethostname()}: has 4 threads; start it with")


def test_a_worker_that_does_not_see_the_folder_is_named(job: Job, tmp_path: Path) -> None:
    words = refusal(replace(job, folder=tmp_path / "elsewhere"))
    assert words.startswith(f"worker on {socket.gethostname()}: {tmp_path / 'elsewhere'}/run.json")
    assert "the run folder must lie on a disk that all machines share" in words


def test_a_worker_with_another_scenario_is_named(job: Job) -> None:
    words = refusal(replace(job, scenario_json=job.scenario_json.replace("75.0", "74.0")))
    assert "scenario and hulls have the hash" in words
    assert "give all machines the same files" in words


def noted(folder: Path, name: str, waits: bool) -> str:
    """Leave a file for every time that a task is carried out, and tell the process."""
    (folder / f"{name}-{time.monotonic_ns()}").touch()
    while waits and not (folder / "go on").exists():
        time.sleep(0.01)
    return str(os.getpid())


def test_what_was_reported_is_not_computed_again_when_its_worker_dies(
    scheduler: str, tmp_path: Path
) -> None:
    """Its chunks are merged by then: a second one would be left behind in the folder."""
    with cluster.connected(scheduler) as client:
        work = [(tmp_path, "first", False), (tmp_path, "second", True)]
        results = cluster.finished(client, noted, work)
        at = {str(pid): address for address, pid in client.run(os.getpid).items()}
        place, pid = next(results)
        assert place == 0 and pid is not None
        os.kill(int(pid), signal.SIGKILL)
        wait_for(lambda: at[pid] not in client.ncores(), "its end")
        (tmp_path / "go on").touch()
        assert [place for place, _ in results] == [1]
    assert len(list(tmp_path.glob("first-*"))) == 1


def test_a_scheduler_that_is_killed_on_the_way_is_named(
    start: Start, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """A real one: dask hears of it while chunks are on their way."""
    address, programs = f"tcp://127.0.0.1:{unused_port()}", []
    for name, *flags in (
        ("dask_scheduler", "--host", address, "--no-dashboard"),
        ("dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard"),
    ):
        program = subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.{name}", *flags],
            cwd=tmp_path,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        request.addfinalizer(program.wait)
        request.addfinalizer(program.kill)
        programs.append(program)
    folder = tmp_path / "study"
    process = start(
        *("study", "ablation", "published", "--policy", "greedy", "--episodes", 400),
        *("--scheduler", address, "--out", folder),
    )
    wait_for(lambda: chunks(folder), "a finished chunk")
    programs[0].kill()
    _, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 2 and err.count("\n") == 1, err
    assert err.startswith("mjforage: ") and "finished chunks are kept" in err


def test_the_workers_compute_and_the_command_does_not(
    start: Start, scheduler: str, tmp_path: Path
) -> None:
    process = start(
        *("evaluate", "published", "--policy", "greedy", "--set", "horizon=5", "--episodes", 30),
        *("--scheduler", scheduler, "--out", tmp_path / "run"),
        before=NO_REPORT + "from mjforage.runs import jobs; jobs.Scorer = None",
    )
    _, err = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, err) == (0, ""), "the command computed itself"


def test_dask_that_is_missing_is_named(
    refused: Refused, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    flags = ("--scheduler", "tcp://a:1", "--out", tmp_path / "run")
    words = refused("evaluate", "comb-port", "--policy", "greedy", *flags)
    assert "dask: needs distributed; install it with pip install 'mjforage[cluster]'" in words
