"""Conformance of learning algorithms: the demands of `mjforage train` on one, ours included."""

import tempfile
from collections.abc import Callable, Mapping
from contextlib import chdir
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
import torch
from numpy.typing import NDArray

from mjforage.graph_planner.networks.inference import values_of
from mjforage.graph_planner.policies import create_policy
from mjforage.learning.training import algorithm_validation
from mjforage.learning.training.algorithm import Algorithm, LearnersPolicy, save_weights
from mjforage.learning.training.algorithms import find_algorithm
from mjforage.learning.training.checkpoint import restore_checkpoint, save_checkpoint
from mjforage.learning.training.hyperparameters import changed
from mjforage.learning.training.progress import Row
from mjforage.learning.training.rounds import Round
from mjforage.mission.mission import Mission
from mjforage.scenario.scenario_file import load_scenario
from mjforage.testing.conformance import ConformanceError, first_difference, run_checks

SETTINGS = {"num_envs": 2, "evaluate_episodes": 2}
MEASURED = ("seconds",)  # what no seed decides


class State(NamedTuple):
    """Copies of a trainer's state after some rounds."""

    arrays: dict[str, NDArray[Any]]  # of its networks and `tensors`, by name
    rows: list[Row]


@dataclass(frozen=True)
class AlgorithmTrial:
    """A learning algorithm, and the conditions of its checks.

    Attributes
    ----------
    algorithm : as of `mjforage train`, or a class
    scenario, overrides : as of `train`
    settings : as `--learning` has them; `SETTINGS` stand before them
    rounds : how many are played, twice
    seed : seed of the run
    """

    algorithm: str | type[Algorithm[Any]]
    scenario: str = "comb-port"
    overrides: tuple[str, ...] = ("horizon=12",)
    settings: Mapping[str, Any] = field(default_factory=dict)
    rounds: int = 2
    seed: int = 0

    @property
    def name(self) -> str:
        """Name in messages."""
        return self.algorithm if isinstance(self.algorithm, str) else self.algorithm.__qualname__

    @cached_property
    def made(self) -> type[Algorithm[Any]]:
        """The class."""
        return find_algorithm(self.algorithm) if isinstance(self.algorithm, str) else self.algorithm

    def fresh(self, **settings: Any) -> Algorithm[Any]:
        """A trainer that has not played."""
        hyperparameters = changed(self.made.settings(), {**SETTINGS, **self.settings, **settings})
        return self.made([load_scenario(self.scenario, self.overrides)], hyperparameters, self.seed)

    def played(self) -> State:
        """After all rounds, played by a fresh trainer."""
        trainer = self.fresh()
        return state_of(trainer, [trainer.play_round() for _ in range(2 * self.rounds)])

    @cached_property
    def whole(self) -> State:
        """The same, played once."""
        return self.played()

    def compare(self, check: str, one: State, other: State, before: str, after: str) -> None:
        """Raise the error of a check, words around the difference, if two states differ."""
        if found := _difference(one, other):
            raise self.error(check, f"{before} {found}{after}")

    def error(self, check: str, words: str) -> ConformanceError:
        """Error of an algorithm that fails a check."""
        return ConformanceError(check, f"algorithm {self.name} {words}")


def state_of(trainer: Algorithm[Any], rows: list[Row]) -> State:
    """Copies of a trainer's tensors and of the weights that it would play with."""
    state = {
        f"weights {team}.{name}": value
        for team, network in trainer.networks.items()
        for name, value in network.state_dict().items()
    } | {f"tensors {name}": value for name, value in trainer.tensors().items()}
    return State({n: v.detach().cpu().numpy().copy() for n, v in state.items()}, rows)


def check_parts(trial: AlgorithmTrial) -> None:
    """Every team that has agents has a network, and the state to save consists of tensors."""
    algorithm_validation.check_parts(trial.fresh())


def check_networks(trial: AlgorithmTrial) -> None:
    """A network gives nine finite numbers for an agent's observation."""
    trainer = trial.fresh()
    trainer.start_round()
    seen = trainer.round.see(np.flatnonzero(trainer.round.active))
    for team, network in trainer.networks.items():
        ids = trainer.agents[team]
        own = {name: level[:, ids].reshape(-1, *level.shape[2:]) for name, level in seen.items()}
        with torch.no_grad():
            given = network({name: torch.from_numpy(level) for name, level in own.items()})
        rows = next(iter(own.values())).shape[0]
        if tuple(given.shape) != (rows, 9):
            raise trial.error(
                "networks",
                f"has one of {team} that gives {tuple(given.shape)} for {rows} rows; `networks` "
                f"has those that are played alone, which give a number for each move, ({rows}, 9)",
            )
        values = values_of(network, own)
        if not np.isfinite(values).all():
            raise trial.error("networks", f"has one of {team} that gives {values[0]}; mend it")


def check_rounds(trial: AlgorithmTrial) -> None:
    """A round plays its episodes to their end, is counted and logged, and some of them learn."""
    trainer = trial.fresh()
    for number in range(1, 2 * trial.rounds + 1):
        algorithm_validation.checked_row(trainer, trainer.play_round())
        if trainer.round.active.any():
            raise trial.error("rounds", "left episodes that go on; play until none is active")
        if trainer.progress.rounds != number:
            raise trial.error(
                "rounds",
                f"counts {trainer.progress.rounds} rounds after {number}; call self.start_round "
                "and self.end_round once in each",
            )
    if not trainer.progress.updates:
        raise trial.error(
            "rounds",
            f"made no update in {2 * trial.rounds} rounds; count them in self.progress.updates, or "
            "give the check settings by which it learns so soon",
        )


def check_repeats(trial: AlgorithmTrial) -> None:
    """The same seed gives the same networks, tensors and rows, to the bit."""
    remedy = "; draw from self.random alone, and seed what torch draws"
    trial.compare("repeats", trial.whole, trial.played(), "of one seed gave", remedy)


def check_copies(trial: AlgorithmTrial) -> None:
    """Arrays that `see` gave are copied before they are stored: they are overwritten later."""
    look = Round.see

    def copied(round: Round, envs: NDArray[np.int64]) -> dict[str, NDArray[np.uint8]]:
        return {name: level.copy() for name, level in look(round, envs).items()}

    with patch.object(Round, "see", copied):
        other = trial.played()
    remedy = (
        ", once by the arrays of self.round.see and once by copies of them; copy what is kept "
        "beyond the next look"
    )
    trial.compare("copies", trial.whole, other, "gave", remedy)


def check_beginning(trial: AlgorithmTrial) -> None:
    """One that begins with the weights of another has its networks."""
    trainer = trial.fresh()
    trainer.play_round()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "begin.safetensors"
        save_weights(trainer, path)
        other = trial.fresh(initial=str(path))
        other.begin()
    before, after = (
        State({n: v for n, v in state_of(one, []).arrays.items() if n.startswith("weights")}, [])
        for one in (trainer, other)
    )
    remedy = (
        ", theirs and its; `networks` gives the modules that train, and `copies` all that begin "
        "with the weights"
    )
    words = "that begins with the weights of another (initial) has"
    trial.compare("beginning", before, after, words, remedy)


def check_resuming(trial: AlgorithmTrial) -> None:
    """Rounds, a checkpoint, and as many rounds by another trainer are twice as many of one."""
    with tempfile.TemporaryDirectory() as folder:
        path, first, second = Path(folder) / "checkpoint", trial.fresh(), trial.fresh()
        rows = [first.play_round() for _ in range(trial.rounds)]
        save_checkpoint(first, path)
        restore_checkpoint(second, path)
    remedy = " before and after `restore`; bring back there all that `tensors` gives"
    trial.compare("resuming", state_of(first, rows), state_of(second, rows), "has", remedy)
    rows += [second.play_round() for _ in range(trial.rounds)]
    remedy = (
        ", in one go and by a checkpoint on the way; keep in `tensors` whatever a later round "
        "depends on, such as the state of an optimiser"
    )
    trial.compare("resuming", trial.whole, state_of(second, rows), "gave", remedy)


def check_weights(trial: AlgorithmTrial) -> None:
    """The weight file is a policy that plays as the networks do."""
    trainer = trial.fresh()
    for _ in range(trial.rounds):
        trainer.play_round()
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        save_weights(trainer, Path("trained-here.safetensors"))
        policies = (
            LearnersPolicy(trainer.networks, trainer.hyperparameters.observation),
            create_policy("trained-here"),
        )
        answers = []
        for policy in policies:
            mission = Mission(trainer.setup)
            mission.reset(trial.seed, np.arange(2))
            mission.prepare(policy)
            answers.append(mission.ask(policy).copy())
    found = first_difference(*answers)
    if found:
        raise trial.error(
            "weights", f"gave {found} by its networks and by their file; save what is played"
        )


ALGORITHM_CHECKS: tuple[Callable[[AlgorithmTrial], None], ...] = (
    check_parts,
    check_networks,
    check_rounds,
    check_repeats,
    check_copies,
    check_resuming,
    check_weights,
    check_beginning,
)


def check_algorithm(
    algorithm: str | type[Algorithm[Any]],
    scenario: str = "comb-port",
    *,
    overrides: tuple[str, ...] = ("horizon=12",),
    settings: Mapping[str, Any] | None = None,
    rounds: int = 2,
    seed: int = 0,
) -> None:
    """Check an algorithm: parts, networks, rounds, repeats, copies, resuming, weights, beginning.

    It has ten trainers play at most twice `rounds` rounds each, on the CPU. What it asks is in
    the docstrings of `mjforage.testing.algorithm_checks`.

    Parameters
    ----------
    algorithm : reference as of `mjforage train`, or a subclass of `Algorithm`
    scenario, overrides : as of `train`
    settings : by name as `--learning` has them, such as `{"warmup": 40}`; choose them so that an
        update comes within `rounds`
    rounds : how many are played before the checkpoint, and after it
    seed : seed of the run

    Raises
    ------
    ConformanceError
        Of the first check that fails.
    """
    trial = AlgorithmTrial(algorithm, scenario, overrides, settings or {}, rounds, seed)
    run_checks(ALGORITHM_CHECKS, trial)


def _difference(one: State, other: State) -> str:
    """First difference between two states, as text; "" if there is none."""
    for name in sorted(one.arrays.keys() ^ other.arrays.keys()):
        return f"{name} once and once not"
    for name, value in one.arrays.items():
        if found := first_difference(value, other.arrays[name]):
            return f"{name} = {found}"
    for number, (row, its_row) in enumerate(zip(one.rows, other.rows, strict=True), 1):
        for name in sorted((row.keys() | its_row.keys()) - set(MEASURED)):
            pair = np.array([row.get(name, np.nan)]), np.array([its_row.get(name, np.nan)])
            if found := first_difference(*pair):
                return f"{name} = {found.partition(' at ')[0]} in round {number}"
    return ""
