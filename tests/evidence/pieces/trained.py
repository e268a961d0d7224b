"""What trainings left: their weights as policies of runs."""

import shutil
from collections.abc import Iterable
from contextlib import chdir
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tests.evidence.playing import Run, play


def run_in(folder: Path, command: str) -> Run:
    """A run where the weights that are in a folder are policies by the names of their files."""
    with chdir(folder):
        return Run(play(command, runs=folder / "fresh"))


def gathered(folders: Iterable[Path], home: Path) -> list[str]:
    """Copy the last weights of trainings into one folder; the names that they have as policies."""
    home.mkdir(exist_ok=True)
    names = []
    for folder in folders:
        names.append(f"{folder.name}-last")
        shutil.copy(folder / "weights.safetensors", home / f"{names[-1]}.safetensors")
    return names


def together(run: Run, policies: Iterable[str], key: str) -> NDArray[np.float64]:
    """Mean of a metric over policies, episode by episode: (episode,)."""
    values: NDArray[np.float64] = np.mean([run.values(name, key) for name in policies], axis=0)
    return values
