"""Base of every training algorithm: scenarios in turn, held-out evaluations, weights, state.

An algorithm is a subclass of `Algorithm` with `settings`, `networks`, `play_round`, `tensors` and
`restore`; run, folder, logs, checkpoints, evaluations and the command line are the same for all.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.encodings import encoder_label
from mjforage.graph_planner.networks.weights import Q_NETWORK, TEAMS, WeightsHeader, header_note
from mjforage.graph_planner.policies.ddqn import QPolicy
from mjforage.graph_planner.policies.registry import check_policies
from mjforage.learning.environments.cores import common_shapes
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.environments.rewards import labelled
from mjforage.learning.training.evaluation import HELD_OUT, Evaluation
from mjforage.learning.training.files import save_tensors
from mjforage.learning.training.hyperparameters import CommonHyperparameters
from mjforage.learning.training.progress import Progress, Row
from mjforage.learning.training.rounds import Round
from mjforage.learning.training.task_families import training_task_of
from mjforage.learning.training.tasks import TrainingTask
from mjforage.mission.task import Task
from mjforage.scenario.scenario import Scenario

if TYPE_CHECKING:
    from torch import Tensor
    from torch.nn import Module

    from mjforage.graph_planner.networks.q_network import MoveNetwork

TRAINED = 1 << 41  # added to training seeds: `evaluate` with the same seed plays other episodes

Settings = TypeVar("Settings", bound=CommonHyperparameters)


class LearnersPolicy(QPolicy):
    """The networks of a run in training, without exploration."""

    def __init__(self, networks: "Mapping[str, MoveNetwork]", encoding: str) -> None:
        self._header = WeightsHeader(encoding, {})
        self._trained = dict(networks)

    def _load(self, task: Task) -> "dict[str, MoveNetwork]":
        return self._trained


class Algorithm(Generic[Settings]):
    """Base of one training run of an algorithm.

    Attributes
    ----------
    settings : class of its hyperparameters, a frozen dataclass on `CommonHyperparameters`
    weights_kind : of the weight files that it writes, in `networks.weights.KINDS`
    learned : losses and other figures of its updates, by name; rows have the means
    hyperparameters, seed, device : as given
    setup : of the first scenario
    tasks : the scenarios; rounds take them in turn
    evaluation : held-out episodes; of the first scenario, until `evaluate_on`
    shapes : of one agent's pictures
    agents : team of `TEAMS` -> its agents
    round : the one under way
    random : source of its draws; a checkpoint keeps its state
    progress : progress of the run
    """

    settings: ClassVar[type[CommonHyperparameters]]
    weights_kind: ClassVar[str] = Q_NETWORK
    learned: ClassVar[tuple[str, ...]] = ("loss",)
    round: Round

    def __init__(
        self,
        scenarios: Sequence[Scenario],
        hyperparameters: Settings,
        seed: int = 0,
        device: str = "cpu",
    ) -> None:
        """Prepare a run.

        Raises `UserError` if a scenario, a setting or the seed is not valid, or fleets or arrays
        differ.

        Parameters
        ----------
        scenarios : rounds take them in turn
        """
        if not 0 <= seed < HELD_OUT:
            raise UserError(f"seed {seed}: out of range; give 0 to {HELD_OUT - 1}")
        self.hyperparameters = replace(
            hyperparameters,
            observation=encoder_label(hyperparameters.observation),
            reward=labelled(hyperparameters.reward),
        )
        self.seed, self.device = seed, device
        home = self._training_task(scenarios[0])
        self.setup = home.setup
        self.evaluation = self._evaluation([home.scenario])
        self.tasks = [
            home,
            *(training_task_of(each, self._training_task) for each in scenarios[1:]),
        ]
        self.shapes = common_shapes([each for task in self.tasks for each in task.examples])
        fleet = self.setup.fleet
        self.agents = dict(zip(TEAMS, (fleet.discoverers, fleet.collectors), strict=True))
        self.random = np.random.Generator(np.random.PCG64(seed))
        self.progress = Progress()
        self._booked = time.perf_counter()

    def _training_task(self, scenario: Scenario) -> TrainingTask:
        settings = self.hyperparameters
        return TrainingTask(self._options(scenario), settings.num_envs, settings.vary)

    def _options(self, scenario: Scenario) -> EnvironmentOptions:
        settings = self.hyperparameters
        return EnvironmentOptions(scenario, settings.world, settings.observation, settings.reward)

    def _evaluation(self, scenarios: Sequence[Scenario]) -> Evaluation:
        return Evaluation(scenarios, self._options, self.hyperparameters.evaluate_episodes)

    def evaluate_on(self, scenarios: Sequence[Scenario]) -> None:
        """Be judged on other scenarios than the first, which share the episodes of an evaluation.

        Raises `UserError` if one is not valid, its fleet or arrays differ, or there are fewer
        episodes than maps.

        Parameters
        ----------
        scenarios : a map of one may be a family of harbours
        """
        evaluation = self._evaluation(scenarios)
        evaluation.check(self.tasks[0].examples[0])
        self.evaluation = evaluation

    @property
    def networks(self) -> "Mapping[str, MoveNetwork]":
        """Team -> network to play and to save; a team without agents has none."""
        raise NotImplementedError

    @property
    def copies(self) -> "Mapping[str, Sequence[Module]]":
        """Team -> all modules that begin with given weights: its one of `networks`, unless an
        algorithm keeps more of them, such as a target network, and says so here.
        """
        return {team: [network] for team, network in self.networks.items()}

    def begin(self) -> None:
        """Have all `copies` begin with the weights that `hyperparameters.initial` names, if any.

        `mjforage train` calls it before the first round. Raises `UserError` if those weights are of
        no use here, see `begin_with`.
        """
        if self.hyperparameters.initial:
            from mjforage.learning.training.initial_weights import begin_with

            begin_with(self.copies, self.hyperparameters, self.setup.task, self.weights_kind)

    def play_round(self) -> Row:
        """Play one episode in every sub-environment to its end, and learn; a row for the log.

        The row has `rounds`, `episodes`, `updates`, `seconds`, `pta_c` and `loss`; updates count
        in `progress`.
        """
        raise NotImplementedError

    def tensors(self) -> "dict[str, Tensor]":
        """Everything that later rounds depend on beside `random` and `progress`."""
        raise NotImplementedError

    def restore(self, state: "Mapping[str, Tensor]") -> None:
        """Restore the state that `tensors` gave."""
        raise NotImplementedError

    def start_round(self) -> None:
        """Start the next episodes, on the scenario whose turn it is."""
        progress, num_envs = self.progress, self.hyperparameters.num_envs
        numbers = np.arange(progress.episodes, progress.episodes + num_envs)
        keys = episode_keys(TRAINED + self.seed, numbers)
        turn, number = divmod(progress.rounds, len(self.tasks))
        self.round = self.tasks[number].round(keys, turn)
        self.round.start(keys)

    def teach(self, teacher: str, updates: int) -> NDArray[np.bool_] | None:
        """The sub-environments (env,) of the round that a teacher plays; None once it is over.

        Parameters
        ----------
        teacher : policy; empty: there is none
        updates : during which it teaches; the share of episodes that it plays falls to 0
        """
        left = 0.0
        if teacher and self.progress.updates < updates:
            left = 1.0 - self.progress.updates / updates
        taught = self.random.random(self.hyperparameters.num_envs) < left
        if left == 0.0:
            return None
        self.round.teach(teacher)
        return taught

    def end_round(self, returns: NDArray[np.float64], learned: Sequence[Row]) -> Row:
        """Count a round that was played to its end.

        Returns: how far the run has come, the round's scores, what an episode had of each term of
        the reward (`reward/NAME`, weighted, all agents), and means over its updates. Raises
        `UserError` if an update tells what the class's `learned` does not name.

        Parameters
        ----------
        returns : (env, agent) of its episodes
        learned : losses and other figures of each update
        """
        unnamed = sorted({name for entry in learned for name in entry} - set(self.learned))
        if unnamed:
            raise UserError(
                f"algorithm {type(self).__name__}: updates report {', '.join(unnamed)}; name them "
                "in its `learned`, or leave them out"
            )
        self.progress.rounds += 1
        self.progress.episodes += self.hyperparameters.num_envs
        self.progress.decisions += int(self.round.steps.sum())
        self.book_time()
        row: Row = {
            **self.come("rounds", "episodes", "updates", "seconds"),
            "pta_c": 100.0 * self.round.collected,
            "length": float(self.round.steps.mean()),
        }
        for team, ids in self.agents.items():
            if ids.size:
                row[f"return_{team}"] = float(returns[:, ids].mean())
        for name, sum_ in self.round.earned.items():
            row[f"reward/{name}"] = sum_ / self.hyperparameters.num_envs
        for name in self.learned:
            found = [entry[name] for entry in learned if name in entry]
            row[name] = float(np.mean(found)) if found else float("nan")
        return row

    def come(self, *names: str) -> Row:
        """Counters of the run, by the names of `Progress`."""
        return {name: float(getattr(self.progress, name)) for name in names}

    def book_time(self) -> None:
        """Add the time since the last call, or since this process began, to the run's."""
        now = time.perf_counter()
        self.progress.seconds += now - self._booked
        self._booked = now

    def evaluate(self) -> Row:
        """Scores on held-out episodes, without exploration; `rank` is better when lower."""
        policy = LearnersPolicy(self.networks, self.hyperparameters.observation)
        row = self.evaluation.scores(policy)
        self.book_time()
        return self.come("rounds", "updates", "seconds") | row


def teacher_label(teacher: str) -> str:
    """A teacher as all spell it; raises `UserError` if there is no such policy."""
    return check_policies([teacher])[0] if teacher else ""


def save_weights(trainer: Algorithm[Any], path: Path) -> None:
    """Write the networks as a weight file that policies can read; none for a team without agents.

    Raises `UserError` if it cannot be written.
    """
    tensors = {
        f"{team}.{name}": value.detach().cpu().contiguous()
        for team, network in trainer.networks.items()
        for name, value in network.state_dict().items()
    }
    notes = tuple(note for task in trainer.tasks for note in task.notes)
    header = WeightsHeader(
        trainer.hyperparameters.observation, trainer.shapes, notes, trainer.weights_kind
    )
    save_tensors(path, tensors, header_note(header))
