"""Conformance of policies: the protocol, and demands of reproducible runs."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import joblib
import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.registry import ImportSpec, is_ours
from mjforage.graph_planner.policies import create_policy
from mjforage.graph_planner.policies.registry import POLICIES, add_policy, policy_class
from mjforage.mission.mission import Mission
from mjforage.mission.policy import Policy, UpperBound
from mjforage.mission.setup import Setup
from mjforage.mission.task import GroundTruth, Observation, Task
from mjforage.physics.vessel_moves import open_setup
from mjforage.scenario.scenario_file import load_scenario
from mjforage.testing.conformance import ConformanceError, first_difference, run_checks

HORIZON, EPISODES = 31, 4
"""Long enough for items to be found in comb-port; a prime, which no counter of moves divides."""

Preferences = NDArray[np.float64]  # (row, agent, 9)
Rows = NDArray[np.int64]


class Frame(NamedTuple):
    """Copies of a policy's inputs at one step, and its answer."""

    observation: Observation
    truth: GroundTruth | None  # for bounds
    answer: Preferences

    def of(self, rows: Rows) -> "Frame":
        """The same for some rows only, in their order."""
        truth = None if self.truth is None else GroundTruth._make(part[rows] for part in self.truth)
        observation = Observation._make(part[rows] for part in self.observation)
        return Frame(observation, truth, self.answer[rows])


@dataclass(frozen=True)
class PolicyTrial:
    """A policy, and the conditions of its checks.

    Attributes
    ----------
    policy : reference, as `--policy`, or a class
    scenario, overrides : as of `evaluate`; episodes are as short as its horizon
    episodes, seed : how many are played side by side, and of which seed
    """

    policy: str | Callable[..., Policy]
    scenario: str = "comb-port"
    overrides: tuple[str, ...] = (f"horizon={HORIZON}",)
    episodes: int = EPISODES
    seed: int = 0

    @property
    def name(self) -> str:
        """Name in messages."""
        policy = self.policy
        return policy if isinstance(policy, str) else getattr(policy, "__qualname__", str(policy))

    def fresh(self) -> Policy:
        """A policy that has not played."""
        return create_policy(self.policy) if isinstance(self.policy, str) else self.policy()

    @cached_property
    def setup(self) -> Setup:
        """Scenario and map."""
        return open_setup(load_scenario(self.scenario, self.overrides))

    @cached_property
    def without_link(self) -> Setup:
        """The same without a link: every agent is a belief owner of its own."""
        return open_setup(load_scenario(self.scenario, (*self.overrides, "link.model=none")))

    @cached_property
    def whole(self) -> list[Frame]:
        """A batch of episodes, played to its end by a fresh policy."""
        return self.played(self.fresh(), range(self.episodes))

    def played(
        self, policy: Policy, episodes: Iterable[int], setup: Setup | None = None
    ) -> list[Frame]:
        """Inputs and answers of a policy along some episodes."""
        mission = Mission(setup or self.setup)
        mission.reset(self.seed, np.array(list(episodes)))
        recorder = _Recorder(policy)
        mission.prepare(recorder)
        bound = isinstance(policy, UpperBound)
        while mission.active.any():
            recorder.truth = mission.truth if bound else None
            mission.advance(mission.ask(recorder))
        return recorder.frames

    def error(self, check: str, words: str) -> ConformanceError:
        """Error of a policy that fails a check."""
        return ConformanceError(check, f"policy {self.name} {words}")


class _Recorder:
    """A policy, with copies of all its inputs and answers."""

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self.frames: list[Frame] = []
        self.truth: GroundTruth | None = None

    def reset(self, task: Task, keys: NDArray[np.uint64]) -> None:
        self._shape = (keys.size, len(task.fleet), 9)
        self._policy.reset(task, keys)

    def act(self, observation: Observation) -> Preferences:
        given = Observation._make(part.copy() for part in observation)
        truth = None
        if isinstance(self._policy, UpperBound) and self.truth is not None:
            truth = GroundTruth._make(part.copy() for part in self.truth)
            self._policy.set_ground_truth(self.truth)
        answer = self._policy.act(observation)
        self.frames.append(Frame(given, truth, np.array(answer, copy=True)))
        return np.asarray(answer)


def check_values(trial: PolicyTrial) -> None:
    """Preferences (row, agent, 9) are finite, or minus infinity, until the episode is over."""
    policy, mission = trial.fresh(), Mission(trial.setup)
    mission.reset(trial.seed, np.arange(trial.episodes))
    mission.prepare(policy)
    while mission.active.any():
        answer = mission.ask(policy)
        wrong = (np.isnan(answer) | (answer == np.inf)) & mission.active[:, None, None]
        if wrong.any():
            place = np.argwhere(wrong)[0]
            raise trial.error(
                "values",
                f"gave {answer[tuple(place)]} for move {place[2]} of agent {place[1]} at step "
                f"{int(mission.step.max()) + 1}; give finite numbers, or -inf for a move never "
                "to be made",
            )
        mission.advance(np.where(np.isnan(answer), 0.0, answer))


def _compare(trial: PolicyTrial, check: str, one: list[Frame], two: list[Frame], why: str) -> None:
    """Both must have answered alike, for rows whose episode is not over."""
    for step, (a, b) in enumerate(zip(one, two, strict=False), start=1):
        active = a.observation.active
        found = first_difference(a.answer[active], b.answer[active])
        if found:
            raise trial.error(check, f"gave {found} (row, agent, move) at step {step} {why}")


def check_repeatable(trial: PolicyTrial) -> None:
    """Two fresh policies with the same keys answer alike: chance comes from the keys alone."""
    again = trial.played(trial.fresh(), range(trial.episodes))
    why = "for the same keys; draw random numbers from the keys of reset or the observation alone"
    _compare(trial, "repeatable", trial.whole, again, why)


def check_reset(trial: PolicyTrial) -> None:
    """After `reset` nothing is left of the episodes before."""
    policy = trial.fresh()
    trial.played(policy, [trial.episodes + 1])
    again = trial.played(policy, range(trial.episodes))
    why = "fresh and after other episodes; let reset forget everything"
    _compare(trial, "reset", trial.whole, again, why)


def check_rows(trial: PolicyTrial) -> None:
    """A row's answer depends on that row alone: whatever the batch, its size and its order."""
    why = "in a batch and in another; read no row but its own"
    _check_parts(trial, "rows", trial.whole, trial.setup, why)


def check_owners(trial: PolicyTrial) -> None:
    """Belief owners that share an episode and its key are answered independently."""
    if isinstance(trial.fresh(), UpperBound):
        return  # a bound gets the truth, once for each episode
    setup = trial.without_link
    frames = trial.played(trial.fresh(), range(trial.episodes), setup)
    why = (
        "beside the other owners of its episode and without; keep what you remember by row, not by "
        "key or episode"
    )
    _check_parts(trial, "owners", frames, setup, why)


def _check_parts(
    trial: PolicyTrial, check: str, frames: list[Frame], setup: Setup, why: str
) -> None:
    """Give some rows of the recorded inputs to a fresh policy: it must answer alike."""
    everyone = np.arange(frames[0].observation.keys.size)
    for rows in (everyone[::-1], everyone[:1], everyone[-1:], everyone[1::2]):
        if not rows.size:
            continue
        policy = trial.fresh()
        policy.reset(setup.task, frames[0].observation.keys[rows])
        given, answered = [frame.of(rows) for frame in frames], []
        for frame in given:
            if frame.truth is not None and isinstance(policy, UpperBound):
                policy.set_ground_truth(frame.truth)
            answered.append(frame._replace(answer=np.array(policy.act(frame.observation))))
        _compare(trial, check, given, answered, why)


def check_worker(trial: PolicyTrial) -> None:
    """Another process finds it by its name, and gets the same answers."""
    text, place = trial.name, None
    made = policy_class(trial.policy) if isinstance(trial.policy, str) else trial.policy
    if not is_ours(made):
        try:
            place = POLICIES.import_spec(trial.name, made)
        except UserError as error:
            raise trial.error("worker", f"cannot be sent to a worker process: {error}") from error
    if not isinstance(trial.policy, str):
        text = f"{made.__module__}:{trial.name}"
    settings = (trial.scenario, trial.overrides, trial.episodes, trial.seed)
    (found,) = joblib.Parallel(n_jobs=2)([joblib.delayed(_answers)(text, place, *settings)])
    for step, (frame, there) in enumerate(zip(trial.whole, found, strict=True), start=1):
        active = frame.observation.active
        difference = first_difference(frame.answer[active], there[active])
        if difference:
            raise trial.error(
                "worker",
                f"gave {difference} (row, agent, move) at step {step} here and in a worker "
                "process; let nothing depend on the process",
            )


def _answers(
    text: str,
    place: ImportSpec | None,
    scenario: str,
    overrides: tuple[str, ...],
    episodes: int,
    seed: int,
) -> list[Preferences]:
    """Answers of a policy in this process."""
    if place is not None:
        add_policy(text, place)
    trial = PolicyTrial(text, scenario, overrides, episodes, seed)
    return [frame.answer for frame in trial.whole]


POLICY_CHECKS = (
    check_values,
    check_repeatable,
    check_reset,
    check_rows,
    check_owners,
    check_worker,
)


def check_policy(
    policy: str | Callable[..., Policy],
    scenario: str = "comb-port",
    overrides: Iterable[str] = (f"horizon={HORIZON}",),
    episodes: int = EPISODES,
    seed: int = 0,
) -> None:
    """All checks of a policy.

    Parameters
    ----------
    policy : reference, such as `my_policies:North(heading=2)`, or a class
    scenario : name of a preset or path of a TOML file
    overrides : KEY=VALUE of the scenario, as `--set`
    episodes, seed : how many are played side by side, and of which seed

    Raises
    ------
    ConformanceError
        Of the first check that fails.
    UserError
        If there is no such policy or scenario.
    """
    trial = PolicyTrial(policy, scenario, tuple(overrides), episodes, seed)
    trial.fresh(), trial.setup  # what is not there says so itself
    run_checks(POLICY_CHECKS, trial)
