"""What is known of chunks while they are played, here and in other processes."""

import shutil
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from mjforage.base.errors import UserError
from mjforage.base.kernel_cache import AWAITED, kernel_folder
from mjforage.graph_planner.policies.registry import POLICIES
from mjforage.mission.setup import Setup
from mjforage.runs import layout
from mjforage.runs import under_way as module
from mjforage.runs.evaluate import THIS_PROCESS, evaluate
from mjforage.runs.under_way import UnderWay, under_way
from mjforage.runs.workers import Workers
from mjforage.scenario.scenario_file import load_scenario

SOURCE = """import time
from pathlib import Path
import numpy as np
from numba.core import event
from mjforage.runs.under_way import under_way


class Slow:
    said = []

    def __init__(self, kind: str = "numba:compile") -> None:
        self.kind = kind

    def reset(self, task, keys):
        self.shape = (keys.size, len(task.fleet), 9)

    def act(self, observation):
        self.said.append(under_way())
        with event.trigger_event(self.kind), event.trigger_event(self.kind):
            self.said.append(under_way())
            self.wait()
        return np.zeros(self.shape)

    def wait(self):
        pass


class Waiting(Slow):
    def wait(self):
        while not Path("seen").exists():
            time.sleep(0.01)


class Broken(Slow):
    def wait(self):
        raise IndexError
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    (tmp_path / "own_slow.py").write_text(SOURCE)
    monkeypatch.chdir(tmp_path)
    path = list(sys.path)
    yield tmp_path
    sys.path[:] = path
    sys.modules.pop("own_slow", None)
    for name in [name for name in POLICIES._registered if name.startswith("own_slow")]:
        del POLICIES._registered[name]


def played(policy: str, workers: Workers = THIS_PROCESS) -> None:
    setup = Setup.of(load_scenario("comb-port", ["horizon=4"]))
    evaluate(setup, [policy], Path("run"), episodes=2, kept=(), workers=workers)


@pytest.mark.parametrize("kind", ["numba:compile", AWAITED])
def test_steps_count_and_compiling_is_told(
    kind: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "EVERY_S", -1.0)
    played(f'own_slow:Slow(kind="{kind}")')
    told = [UnderWay(compiles, n * 2 / 4) for n in range(4) for compiles in (False, True)]
    assert sys.modules["own_slow"].Slow.said == told
    assert under_way() == UnderWay(False, 0.0)
    assert not (folder / "run" / "chunks").exists()


@pytest.mark.parametrize("workers", [Workers(jobs=2), Workers(local_cluster=1)])
def test_what_other_processes_do_is_known(folder: Path, workers: Workers) -> None:
    if workers.remote:
        pytest.importorskip("distributed")
    found: list[UnderWay] = []

    def look() -> None:
        while not under_way().compiles and not over.is_set():
            time.sleep(0.01)
        found.append(under_way())
        (folder / "seen").touch()

    over, thread = threading.Event(), threading.Thread(target=look)
    thread.start()
    try:
        played("own_slow:Waiting", workers)
    finally:
        over.set()
        thread.join()
    assert found[0].compiles


def test_what_a_stopped_run_left_is_not_taken_for_news(folder: Path) -> None:
    with pytest.raises(UserError, match="own_slow:Broken: raised IndexError"):
        played("own_slow:Broken")
    assert under_way() == UnderWay(False, 0.0)
    (left,) = (folder / "run" / "chunks" / ".under-way").iterdir()
    left.write_text("[true, 1.0]")  # as one leaves it that is killed
    with module.waiting([left.parent]):
        assert under_way() == UnderWay(False, 0.0)


def test_a_file_that_is_just_being_written_says_nothing(tmp_path: Path) -> None:
    with module.waiting([tmp_path / "told"]), module.telling(tmp_path / "told" / "chunk", 8, 4):
        (tmp_path / "told" / "chunk").write_text("[tr")
        assert under_way() == UnderWay(False, 0.0)


KERNEL = """import os, time
from pathlib import Path
import numpy as np
from numba.core import event
from mjforage.base.compiled import kernel

HERE = Path(__file__).parent  # workers may have begun in another folder


class Heard(event.Listener):
    def on_start(self, event):
        with (HERE / "compiled").open("a") as file:
            file.write(event.data["dispatcher"].py_func.__name__ + " ")

    def on_end(self, event):
        pass


@kernel
def own_total(x):
    total = 0.0
    for i in range(x.size):
        total += own_half(x[i])
    return total


@kernel
def own_half(x):
    return 0.5 * x


class Compiling:
    def reset(self, task, keys):
        self.shape = (keys.size, len(task.fleet), 9)

    def act(self, observation):
        (HERE / f"here-{os.getpid()}").touch()
        while len(list(HERE.glob("here-*"))) < 2:
            time.sleep(0.001)
        listener = Heard()
        event.register("numba:compile", listener)
        own_total(np.ones(3))
        event.unregister("numba:compile", listener)
        return np.zeros(self.shape)
"""


def test_workers_compile_a_kernel_once(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each has a chunk and wants it at the same moment."""
    monkeypatch.setattr(layout, "CHUNK", 1)
    (folder / "own_slow.py").write_text(KERNEL)
    cache = kernel_folder()
    assert cache is not None
    for path in cache.glob("own_slow.*.nbc"):  # of one that was stopped
        path.unlink()
    for told in ("own_half own_total", ""):
        played("own_slow:Compiling", Workers(jobs=2))
        compiled = (folder / "compiled").read_text() if (folder / "compiled").exists() else ""
        assert " ".join(sorted(compiled.split())) == told
        (folder / "compiled").unlink(missing_ok=True)
        shutil.rmtree(folder / "run")
    for path in cache.glob("own_slow.*.nbc"):
        path.unlink()
