"""Run the commands of pieces, each once, and read their results."""

import hashlib
import importlib
import json
import shlex
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any
from unittest.mock import patch

from numpy.typing import NDArray

from mjforage.base.called import called
from mjforage.base.errors import UserError
from mjforage.cli.commands import app
from mjforage.runs.run_info import load_run, read_json
from mjforage.view.report.run_logs import load_episodes, scalar
from mjforage.view.report.studies.study_logs import StudyLogs, load_study
from tests.evidence.piece import REPOSITORY

FRESH = "--fresh"
"""The option that a command asks for where the code has changed, and that it then gets."""
RUNS = REPOSITORY / "runs" / "evidence"
FIGURES = "figures.json"  # of a command that makes no folder


def plain(command: str) -> list[str]:
    """Words of a command without its first, and without who computes, which changes no number."""
    words = shlex.split(command)[1:]
    if "--jobs" in words:
        at = words.index("--jobs")
        del words[at : at + 2]
    return words


def place(command: str, runs: Path = RUNS) -> Path:
    """Folder of a command; two pieces that name the same command share it."""
    words = plain(command)
    digest = hashlib.sha256(shlex.join(words).encode()).hexdigest()[:8]
    named = [word for word in words[:3] if word.replace("-", "").isalnum() and word[0] != "-"]
    return runs / "-".join([*named, digest])


def play(command: str, jobs: int = 1, runs: Path = RUNS) -> Path:
    """Carry out what is missing of a command, and return its folder.

    A run that other code has begun is put aside and begun anew.

    Raises
    ------
    UserError
        As the command.
    """
    words, folder = plain(command), place(command, runs)
    folder.parent.mkdir(parents=True, exist_ok=True)
    if words[0] in ("bench", "-m"):
        folder.mkdir(exist_ok=True)
        words += ["--json", str(folder / FIGURES)]
        if words[0] == "-m":  # of the tests
            importlib.import_module(words[1]).main(words[2:])
        else:
            _carry_out(words)
        return folder
    words += ["--out", str(folder)]
    words += [] if words[0] == "train" else ["--jobs", str(jobs)]
    words += ["--replay", "none"] if words[0] in ("evaluate", "compare") else []
    try:
        _carry_out(words)
    except UserError as error:
        if FRESH not in str(error):
            raise
        _carry_out([*words, FRESH])
    return folder


def _carry_out(words: list[str]) -> None:
    """Run a command of ours in this process, without the figures of its report."""
    function, bound, _ = app.parse_args(words, exit_on_error=False, print_error=False)
    with (
        called(shlex.join(["mjforage", *words])),
        patch("mjforage.view.report.draw_figures", lambda logs: []),
    ):
        function(*bound.args, **bound.kwargs)


class Run:
    """A finished run folder: metrics of its episodes."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.info = load_run(folder / "run.json")
        self._episodes = load_episodes(folder, self.info)

    def values(self, policy: str, key: str, world: str | None = None) -> NDArray[Any]:
        """A metric of a policy, in the run's first world if none is named: (episode,).

        Raises
        ------
        KeyError
            If the run has no such policy, world or metric.
        """
        world = self.info.worlds[0] if world is None else world
        rows = self._episodes.filter(policy=policy, world=world)
        if not rows.height or key not in rows.columns:
            raise KeyError(f"{self.folder}: has no {key} of {policy} in {world}")
        return scalar(rows, key)


class Runs:
    """Results of the commands of a piece, read when they are asked for."""

    def __init__(self, folders: Mapping[str, Path]) -> None:
        self.folders = dict(folders)
        self._read: dict[str, Run] = {}

    def __getitem__(self, label: str) -> Run:
        if label not in self._read:
            self._read[label] = Run(self.folders[label])
        return self._read[label]

    @cached_property
    def study(self) -> StudyLogs:
        """The only study."""
        return load_study(self.folders[""])

    @cached_property
    def figures(self) -> Any:
        """JSON of the only command, if it leaves no run."""
        return json.loads((self.folders[""] / FIGURES).read_text("utf-8"))


def facts(folder: Path) -> dict[str, Any]:
    """Seed, episodes, hash and CPU minutes of a run; of a study its variants' sum.

    Empty for a folder without a run.
    """
    files = [*sorted(folder.glob("variants/*/run.json")), *folder.glob("run.json")]
    if not files:
        return {}
    found = [read_json(file) for file in files]
    hashes = [one["hash"] for one in found]
    digest = hashlib.sha256("".join(hashes).encode()).hexdigest()[:16]
    return {
        "seed": found[0]["seed"],
        "episodes": found[0]["episodes"],
        "hash": hashes[0] if len(hashes) == 1 else digest,
        "cpu_minutes": round(sum(one["timings"]["cpu_s"] for one in found) / 60, 1),
    }
