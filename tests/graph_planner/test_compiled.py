"""Compiled kernels must follow the sources of everything that they call."""

import subprocess
import sys
from pathlib import Path

CALLER = """
from graph_planner.compiled import kernel
from flotilla.helm import rudder

@kernel
def steer(x: float) -> float:
    return rudder(x) + 1.0
"""
HELM = """
from graph_planner.compiled import {decorator}

@{decorator}
def rudder(x: float) -> float:
    return {factor} * x
"""
ASK = (
    "from flotilla.steering import steer; print(steer(10.0), sum(steer.stats.cache_hits.values()))"
)


def ask(folder: Path) -> list[float]:
    done = subprocess.run(
        [sys.executable, "-c", ASK], cwd=folder, capture_output=True, text=True, check=True
    )
    return [float(word) for word in done.stdout.split()]


def test_a_kernel_is_compiled_again_when_a_file_that_it_calls_changes(tmp_path: Path) -> None:
    package = tmp_path / "flotilla"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "steering.py").write_text(CALLER)
    for decorator in ("kernel", "inlined"):
        (package / "helm.py").write_text(HELM.format(decorator=decorator, factor=2.0))
        assert ask(tmp_path) == [21.0, 0.0]
        assert ask(tmp_path) == [21.0, 1.0]  # unchanged: taken from the disk
        (package / "helm.py").write_text(HELM.format(decorator=decorator, factor=3.25))
        assert ask(tmp_path) == [33.5, 0.0]
