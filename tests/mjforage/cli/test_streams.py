"""Commands whose words nobody reads, or that stand where letters or space are missing."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

RUN = ("evaluate", "comb-port", "--policy", "greedy", "--set", "horizon=3", "--episodes", "1")
COMMAND = f"{sys.executable} -m mjforage"
full = pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
needs_shell = pytest.mark.skipif(os.name != "posix", reason="needs a POSIX shell")
pytestmark = [needs_shell, pytest.mark.usefixtures("compiled")]


@pytest.fixture(scope="module")
def compiled(finished: Path) -> None:
    """Compile all kernels, so that no process waits for that."""
    assert finished.is_dir()


def shell(line: str, folder: Path, **variables: str) -> "subprocess.CompletedProcess[bytes]":
    """Run a line of bash; each `mjforage` in it is the command."""
    root = Path(__file__).parents[3]
    return subprocess.run(
        ["bash", "-c", line.replace("mjforage ", f"{COMMAND} ", 1)],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(root)} | variables,
        capture_output=True,
        check=False,
    )


def faults(done: "subprocess.CompletedProcess[bytes]") -> list[bytes]:
    """Return what was said on stderr, without how far it has come, which a slow machine says."""
    return [line for line in done.stderr.splitlines() if not line.endswith((b"so far", b"left"))]


@pytest.mark.parametrize("reader", ["| head -1", "2>&1 | true"])
def test_a_reader_that_goes_leaves_a_whole_run_and_no_word(reader: str, tmp_path: Path) -> None:
    line = f"mjforage {' '.join(RUN)} --replay none -o run {reader}; exit ${{PIPESTATUS[0]}}"
    done = shell(line, tmp_path)
    assert (done.returncode, faults(done)) == (0, [])
    assert done.stdout.count(b"\n") == reader.count("head")
    assert (tmp_path / "run" / "summary.json").is_file()
    assert (tmp_path / "run" / "report.html").is_file()


@full
@pytest.mark.parametrize("command", [" ".join(RUN), "metrics", "--help", "scenarios open-bay"])
def test_a_full_standard_output_is_one_line(command: str, tmp_path: Path) -> None:
    done = shell(f"mjforage {command} > /dev/full", tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(b"mjforage: standard output: cannot be written (No space left")
    assert done.stderr.count(b"\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("line", ["scenarios open-bay >&-", "metrics >&-", "nonsense 2>&-"])
def test_closed_streams_are_no_fault(line: str, tmp_path: Path) -> None:
    done = shell(f"mjforage {line}", tmp_path)
    assert (done.returncode, done.stderr) == (2 if "nonsense" in line else 0, b"")


@pytest.mark.parametrize(
    "variables",
    [
        {"PYTHONIOENCODING": "ascii"},
        {"PYTHONIOENCODING": "latin-1"},
        {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    ],
)
def test_an_encoding_without_our_letters_is_no_fault(
    variables: dict[str, str], tmp_path: Path
) -> None:
    done = shell(f"mjforage {' '.join(RUN)} --replay none -o run", tmp_path, **variables)
    assert (done.returncode, faults(done)) == (0, [])
    spelt = "mean ±" if variables.get("PYTHONIOENCODING") == "latin-1" else "mean +- 1.96 SEM"
    assert spelt.encode("latin-1") in done.stdout
    (tmp_path / "mine.toml").write_text('name = "x"  # °, ±\n', encoding="utf-8")
    told = shell("mjforage scenarios comb-port", tmp_path, **variables)
    assert told.stdout == shell("mjforage scenarios comb-port", tmp_path).stdout
