"""Commands whose output is closed, or lacks letters or space."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

COMMAND = f"{sys.executable} -m mjforage"
pytestmark = pytest.mark.skipif(os.name != "posix", reason="needs a POSIX shell")


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


@pytest.mark.parametrize("command", ["metrics", "scenarios open-bay", "evaluate --help"])
def test_a_command_ends_quietly_when_its_reader_is_gone(command: str, tmp_path: Path) -> None:
    done = shell(f"mjforage {command} | true; exit ${{PIPESTATUS[0]}}", tmp_path)
    assert done.returncode in (0, 1) and done.stderr == b""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_standard_output_is_an_error(tmp_path: Path) -> None:
    done = shell("mjforage scenarios open-bay > /dev/full", tmp_path)
    assert done.returncode != 0 and b"No space left on device" in done.stderr


@pytest.mark.parametrize("line", ["scenarios open-bay >&-", "metrics >&-", "nonsense 2>&-"])
def test_closed_streams_are_no_fault(line: str, tmp_path: Path) -> None:
    done = shell(f"mjforage {line}", tmp_path)
    assert (done.returncode, done.stderr) == (2 if "nonsense" in line else 0, b"")


def test_an_encoding_without_our_letters_is_no_fault(tmp_path: Path) -> None:
    (tmp_path / "höfn.csv").write_text("1,1\n1,1\n")
    done = shell("mjforage maps höfn.csv", tmp_path, PYTHONIOENCODING="ascii")
    assert (done.returncode, done.stderr) == (0, b"")
    assert done.stdout == b"h?fn.csv: 2 x 2, 4 nodes\n"
    told = shell("mjforage scenarios comb-port", tmp_path, PYTHONIOENCODING="ascii")
    assert told.stdout == shell("mjforage scenarios comb-port", tmp_path).stdout


def test_a_live_stream_tells_its_address_and_ends_by_ctrl_c(folder: Path, tmp_path: Path) -> None:
    heeds = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"  # if ignored
    words = ["stream", str(folder), "--port", "0"]
    program = f"{heeds}\nfrom mjforage.cli import main\nmain({words!r})"
    root = os.environ | {"PYTHONPATH": str(Path(__file__).parents[3]), "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env=root,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as serving:
        assert serving.stdout is not None
        assert serving.stdout.readline().startswith("stream: ws://127.0.0.1:")
        serving.send_signal(signal.SIGINT)
        try:
            _, told = serving.communicate(timeout=120)
        finally:
            serving.kill()
    assert "interrupted" in told
    assert serving.returncode == 130
