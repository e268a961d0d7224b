"""Kernels on disk follow the content of all that they call, and a folder that cannot be used."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = {
    "__init__.py": "",
    "steering.py": """
from typing import NamedTuple
from mjforage.base.compiled import kernel
from flotilla import chart
from flotilla.helm import rudder

GAINS = (1.0, 2.0)

class Order(NamedTuple):
    course: float
    speed: float

@kernel
def steer(order: Order) -> float:
    return order.course + 2.0 * rudder(order.speed) + GAINS[1] + chart.DEPTH
""",
    "helm.py": """
from mjforage.base.compiled import inlined, kernel
from flotilla.wheel import turned

@kernel
def rudder(x: float) -> float:
    return 3.0 * turned(x)

@kernel
def unused(x: float) -> float:
    return x
""",
    "wheel.py": """
from mjforage.base.compiled import kernel

@kernel
def turned(x: float) -> float:
    \"\"\"Twice.\"\"\"
    return 2.0 * x
""",
    "chart.py": "DEPTH = 5.0\nNAME = 'harbour'\n",
}
FIRST = 1.0 + 2.0 * 3.0 * 2.0 * 10.0 + 2.0 + 5.0
ASK = """
from flotilla.steering import Order, steer
print(steer(Order(course=1.0, speed=10.0)), sum(steer.stats.cache_hits.values()))
"""


def written(folder: Path) -> Path:
    package = folder / "flotilla"
    package.mkdir(parents=True)
    for name, text in PACKAGE.items():
        (package / name).write_text(text)
    return package


def run(folder: Path, cache: Path, program: str = ASK) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, "-c", program],
        cwd=folder,
        env=os.environ | {"NUMBA_CACHE_DIR": str(cache)},
        capture_output=True,
        text=True,
        check=True,
    )


def ask(folder: Path, cache: Path) -> tuple[float, bool]:
    """What the kernel answers, and whether it was found on the disk."""
    answer, hits = run(folder, cache).stdout.split()
    return float(answer), hits == "1"


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the kernels of `PACKAGE` are kept."""
    folder = tmp_path_factory.mktemp("compiled")
    written(folder / "first")
    assert ask(folder / "first", folder / "kept") == (FIRST, False)
    return folder / "kept"


@pytest.mark.parametrize(
    ("file", "old", "new", "answer"),
    [
        pytest.param("wheel.py", "2.0 * x", "4.0 * x", FIRST + 120.0, id="called by another"),
        pytest.param("helm.py", "3.0 *", "3.5 *", FIRST + 20.0, id="called"),
        pytest.param("steering.py", "1.0, 2.0", "1.0, 2.5", FIRST + 0.5, id="a constant"),
        pytest.param("chart.py", "5.0", "6.0", FIRST + 1.0, id="a constant of a module"),
        pytest.param(
            "steering.py",
            "    course: float\n    speed: float",
            "    speed: float\n    course: float",
            FIRST,
            id="order of the fields of an argument",
        ),
    ],
)
def test_a_kernel_is_compiled_again_when_what_it_depends_on_changes(
    file: str, old: str, new: str, answer: float, compiled: Path, tmp_path: Path
) -> None:
    path = written(tmp_path) / file
    path.write_text(path.read_text().replace(old, new))
    assert ask(tmp_path, compiled) == (answer, False)
    assert ask(tmp_path, compiled) == (answer, True)


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        pytest.param("helm.py", "return x\n", "return x + 1.0\n", id="another function"),
        pytest.param("wheel.py", "Twice.", "Two times x.", id="a docstring"),
        pytest.param("steering.py", "GAINS =", "# gains\n\nGAINS =", id="a comment, other lines"),
        pytest.param("chart.py", "harbour", "port", id="a name that no kernel reads"),
        pytest.param("chart.py", "harbour", "harbour", id="another folder"),
    ],
)
def test_a_kernel_is_not_compiled_again_for_what_it_does_not_depend_on(
    file: str, old: str, new: str, compiled: Path, tmp_path: Path
) -> None:
    path = written(tmp_path) / file
    path.write_text(path.read_text().replace(old, new))
    assert ask(tmp_path, compiled) == (FIRST, True)


@pytest.mark.parametrize("hash_seed", ["0", "1"])  # for which the two flags change places
def test_the_order_of_a_set_is_no_part_of_a_kernel(hash_seed: str) -> None:
    source = (
        "from mjforage.base.kernel_content import content\n"
        "from mjforage.graph_planner.belief_planner.routes import _rest_roughly\n"
        "print(content(_rest_roughly))"
    )
    environment = os.environ | {"PYTHONHASHSEED": hash_seed}
    command = [sys.executable, "-c", source]
    said = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert "('fastmath', ['contract', 'reassoc'])" in said.stdout


def test_a_spoilt_file_is_compiled_anew(compiled: Path, tmp_path: Path) -> None:
    written(tmp_path)
    for path in compiled.rglob("flotilla*.nbc"):
        (tmp_path / "kept" / "mjforage").mkdir(parents=True, exist_ok=True)
        (tmp_path / "kept" / "mjforage" / path.name).write_bytes(b"")
    assert ask(tmp_path, tmp_path / "kept") == (FIRST, False)
    assert ask(tmp_path, tmp_path / "kept") == (FIRST, True)


def test_kernels_that_nobody_read_for_long_go_when_another_is_written(tmp_path: Path) -> None:
    written(tmp_path)
    kept = tmp_path / "kept" / "mjforage"
    kept.mkdir(parents=True)
    for name in ("old.nbc", "new.nbc"):
        (kept / name).touch()
    os.utime(kept / "old.nbc", (0.0, 0.0))
    ask(tmp_path, tmp_path / "kept")
    names = [path.name.partition("-")[0] for path in kept.iterdir()]
    assert "old.nbc" not in names and "new.nbc" in names
    assert "flotilla.steering.steer" in names


SHOWN = "import logging\nlogging.basicConfig()\n"
TWICE = SHOWN + ASK + "from flotilla.helm import unused\nunused(1.0)\n"


def test_a_folder_that_cannot_be_made_is_told_once_with_the_remedy(tmp_path: Path) -> None:
    written(tmp_path)
    (tmp_path / "file").touch()
    said = run(tmp_path, tmp_path / "file", TWICE)
    assert said.stdout.split() == [str(FIRST), "0"]
    assert said.stderr.count("\n") == 1, said.stderr
    assert "compiled kernels cannot be kept in" in said.stderr
    assert "set NUMBA_CACHE_DIR to a folder that you can write to" in said.stderr


def test_a_folder_that_cannot_be_written_is_read(compiled: Path, tmp_path: Path) -> None:
    written(tmp_path)
    folder = compiled / "mjforage"
    before = {path.name for path in folder.iterdir()}
    folder.chmod(0o555)
    try:
        assert ask(tmp_path, compiled) == (FIRST, True)
    finally:
        folder.chmod(0o755)
    assert {path.name for path in folder.iterdir()} == before


def test_a_user_without_a_home_goes_on(tmp_path: Path) -> None:
    written(tmp_path)
    program = (
        "import os; from pathlib import Path\n"
        "for name in ('NUMBA_CACHE_DIR', 'XDG_CACHE_HOME', 'HOME'): os.environ.pop(name, None)\n"
        "def lost(): raise RuntimeError('Could not determine home directory.')\n"
        "Path.home = lost\n"
    )
    said = run(tmp_path, tmp_path / "kept", program + TWICE)
    assert said.stdout.split() == [str(FIRST), "0"]
    assert said.stderr.count("cannot be kept") == 1 and "set NUMBA_CACHE_DIR" in said.stderr
    assert not (tmp_path / "kept").exists()


TOGETHER = """
import sys, time
from pathlib import Path
from numba.core import event
from mjforage.base.compiled import compiling
from flotilla.steering import Order, steer

class Heard(event.Listener):
    def __init__(self, words):
        self.words = words
    def on_start(self, event):
        of = (event.data or {}).get("dispatcher")
        bare = of and of.targetoptions.get("no_cpython_wrapper")
        print(self.words, compiling(), of and of.py_func.__name__, bare)
    def on_end(self, event):
        pass

event.register("numba:compile", Heard("compiles"))
Path(sys.argv[1]).touch()
while len(list(Path(".").glob("ready-*"))) < 3:
    time.sleep(0.001)
print(steer(Order(course=1.0, speed=10.0)))
"""


def started(folder: Path, cache: Path, number: int) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-c", TOGETHER, f"ready-{number}"],
        cwd=folder,
        env=os.environ | {"NUMBA_CACHE_DIR": str(cache)},
        stdout=subprocess.PIPE,
        text=True,
    )


def test_of_processes_that_want_a_kernel_one_compiles_it(tmp_path: Path) -> None:
    written(tmp_path)
    processes = [started(tmp_path, tmp_path / "kept", number) for number in range(3)]
    said = "".join(process.communicate(timeout=600)[0] for process in processes).splitlines()
    assert [process.returncode for process in processes] == [0, 0, 0]
    assert said.count(str(FIRST)) == 3
    compiled = [line for line in said if line.startswith("compiles")]
    assert sorted(compiled) == [
        "compiles True rudder True",
        "compiles True steer False",
        "compiles True turned True",
    ]
    assert not list(tmp_path.rglob("*.lock"))


KILLED = """
import os, signal
from numba.core import event

class Dies(event.Listener):
    def on_start(self, event):
        os.kill(os.getpid(), signal.SIGKILL)
    def on_end(self, event):
        pass

event.register("numba:compile", Dies())
"""


def test_one_that_is_killed_while_it_compiles_holds_nobody_up(tmp_path: Path) -> None:
    written(tmp_path)
    with pytest.raises(subprocess.CalledProcessError):
        run(tmp_path, tmp_path / "kept", KILLED + ASK)
    assert list(tmp_path.rglob("flotilla.steering.steer-*.lock"))
    assert ask(tmp_path, tmp_path / "kept") == (FIRST, False)


def test_one_that_cannot_compile_lets_others_try(tmp_path: Path) -> None:
    package = written(tmp_path)
    (package / "wheel.py").write_text(PACKAGE["wheel.py"].replace("2.0 * x", "x.y"))
    with pytest.raises(subprocess.CalledProcessError) as caught:
        run(tmp_path, tmp_path / "kept")
    assert "TypingError" in caught.value.stderr and not list(tmp_path.rglob("*.lock"))
