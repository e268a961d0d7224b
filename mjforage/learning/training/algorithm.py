"""What every training algorithm shares: scenarios in turn, held-out evaluations, weights, state.

An algorithm is a subclass of `Algorithm` with `settings`, `networks`, `play_round`, `tensors` and
`restore`; run, folder, logs, checkpoints, evaluations and the command line are the same for all.
"""

import logging
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from graph_planner.encodings import encoder_label
from graph_planner.policies.ddqn import QPolicy
from graph_planner.policies.registry import check_policies
from graph_planner.randomness import episode_keys
from graph_planner.task import Task
from graph_planner.weights import KINDS, Q_NETWORK, TEAMS, WeightsHeader, header_note
from mjforage.core.errors import UserError
from mjforage.core.scenario import Scenario
from mjforage.core.schema import OPEN
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.environments.rewards import labelled
from mjforage.learning.training.evaluation import HELD_OUT, Evaluation
from mjforage.learning.training.families import ground_on
from mjforage.learning.training.files import save_tensors
from mjforage.learning.training.grounds import Ground, common_shapes
from mjforage.learning.training.hyperparameters import CommonHyperparameters
from mjforage.learning.training.rounds import Round

if TYPE_CHECKING:
    from torch import Tensor
    from torch.nn import Module

    from graph_planner.q_network import MoveNetwork

TRAINED = 1 << 41  # added to training seeds: `evaluate` with the same seed plays other episodes

logger = logging.getLogger(__name__)

Row = dict[str, float]
ALWAYS = ("rounds", "episodes", "updates", "seconds", "pta_c")  # of every round's row
Told = TypeVar("Told", bound=CommonHyperparameters)


class LearnersPolicy(QPolicy):
    """The networks of a run in training, without exploration."""

    def __init__(self, networks: "Mapping[str, MoveNetwork]", encoding: str) -> None:
        self._header = WeightsHeader(encoding, {})
        self._trained = dict(networks)

    def _load(self, task: Task) -> "dict[str, MoveNetwork]":
        return self._trained


@dataclass
class Progress:
    """How far a run has come."""

    __pydantic_config__ = OPEN | {"allow_inf_nan": True}  # `best` before an evaluation

    rounds: int = 0
    episodes: int = 0
    decisions: int = 0  # steps of all episodes
    updates: int = 0  # of each team's network
    due: float = 0.0  # updates that steps have earned
    seconds: float = 0.0  # since the start of the run, over all processes that worked on it
    evaluated: int = 0  # updates at the last evaluation that was due
    best: float = float("inf")  # of the evaluations' `rank`


@dataclass
class Clock:
    """CPU seconds by what they went into."""

    seconds: dict[str, float] = field(
        default_factory=lambda: dict.fromkeys(("environment", "network", "replay", "teacher"), 0.0)
    )

    def __call__(self, part: str, work: Callable[[], Any]) -> Any:
        """Do work and book its time."""
        started = time.process_time()
        result = work()
        self.seconds[part] += time.process_time() - started
        return result


class Algorithm(Generic[Told]):
    """Base of one training run of an algorithm.

    Attributes
    ----------
    settings : class of its hyperparameters, a frozen dataclass on `CommonHyperparameters`
    weights_kind : of the weight files that it writes, in `graph_planner.weights.KINDS`
    learned : what each of its updates tells, by name; rows have the means
    hyperparameters, seed, device : as given
    setup : of the first scenario
    grounds : the scenarios; rounds take them in turn
    evaluation : on what the networks are judged; the first scenario, until `evaluate_on`
    shapes : of one agent's pictures
    agents : team of `TEAMS` -> its agents
    round : the one under way
    random : source of its draws; a checkpoint keeps its state
    progress : how far it has come
    clock : where the time went
    """

    settings: ClassVar[type[CommonHyperparameters]]
    weights_kind: ClassVar[str] = Q_NETWORK
    learned: ClassVar[tuple[str, ...]] = ("loss",)
    round: Round

    def __init__(
        self,
        scenarios: Sequence[Scenario],
        hyperparameters: Told,
        seed: int = 0,
        device: str = "cpu",
    ) -> None:
        """Prepare a run.

        Parameters
        ----------
        scenarios : rounds take them in turn

        Raises
        ------
        UserError
            If a scenario, a setting or the seed is not valid, or fleets or arrays differ.
        """
        if not 0 <= seed < HELD_OUT:
            raise UserError(f"seed {seed}: out of range; give 0 to {HELD_OUT - 1}")
        self.hyperparameters = replace(
            hyperparameters,
            observation=encoder_label(hyperparameters.observation),
            reward=labelled(hyperparameters.reward),
        )
        self.seed, self.device = seed, device
        home = self._ground(scenarios[0])
        self.setup = home.setup
        self.evaluation = self._evaluation([home.scenario])
        self.grounds = [home, *(ground_on(each, self._ground) for each in scenarios[1:])]
        self.shapes = common_shapes([each for ground in self.grounds for each in ground.examples])
        fleet = self.setup.fleet
        self.agents = dict(zip(TEAMS, (fleet.discoverers, fleet.collectors), strict=True))
        self.random = np.random.Generator(np.random.PCG64(seed))
        self.progress, self.clock = Progress(), Clock()
        self._booked = time.perf_counter()

    def _ground(self, scenario: Scenario) -> Ground:
        told = self.hyperparameters
        return Ground(self._options(scenario), told.num_envs, told.vary)

    def _options(self, scenario: Scenario) -> EnvironmentOptions:
        told = self.hyperparameters
        return EnvironmentOptions(scenario, told.world, told.observation, told.reward)

    def _evaluation(self, scenarios: Sequence[Scenario]) -> Evaluation:
        return Evaluation(scenarios, self._options, self.hyperparameters.evaluate_episodes)

    def evaluate_on(self, scenarios: Sequence[Scenario]) -> None:
        """Be judged on other scenarios than the first, which share the episodes of an evaluation.

        Parameters
        ----------
        scenarios : a map of one may be a family of harbours

        Raises
        ------
        UserError
            If one is not valid, its fleet or arrays differ, or there are fewer episodes than maps.
        """
        evaluation = self._evaluation(scenarios)
        evaluation.check(self.grounds[0].examples[0])
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

        `mjforage train` calls it before the first round.

        Raises
        ------
        UserError
            If those weights are of no use here, see `begin_with`.
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
        """Take back what `tensors` gave."""
        raise NotImplementedError

    def start_round(self) -> None:
        """Start the next episodes, on the scenario whose turn it is."""
        progress, num_envs = self.progress, self.hyperparameters.num_envs
        numbers = np.arange(progress.episodes, progress.episodes + num_envs)
        keys = episode_keys(TRAINED + self.seed, numbers)
        turn, number = divmod(progress.rounds, len(self.grounds))
        self.round = self.grounds[number].round(keys, turn)
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

        Parameters
        ----------
        returns : (env, agent) of its episodes
        learned : what each update tells

        Returns
        -------
        How far the run has come, the round's scores, what an episode had of each term of the
        reward (`reward/NAME`, weighted, all agents), and means over its updates

        Raises
        ------
        UserError
            If an update tells what the class's `learned` does not name.
        """
        unnamed = sorted({name for entry in learned for name in entry} - set(self.learned))
        if unnamed:
            raise UserError(
                f"algorithm {type(self).__name__}: updates tell {', '.join(unnamed)}; name them in "
                "its `learned`, or leave them out"
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

    def check_parts(self) -> None:
        """Refuse networks and tensors that evaluations and checkpoints could do nothing with.

        Of a network that trains and whose weights no policy plays there is a warning.

        Raises
        ------
        UserError
            If a team that has agents has no network, or what is to be kept is no tensor.
        """
        import torch

        who, networks, tensors = f"algorithm {type(self).__name__}", self.networks, self.tensors()
        if not isinstance(networks, Mapping) or not isinstance(tensors, Mapping):
            raise UserError(
                f"{who}: networks and tensors() are {type(networks).__name__} and "
                f"{type(tensors).__name__}; make both a dict"
            )
        for team, ids in self.agents.items():
            made = networks.get(team)
            if ids.size and not isinstance(made, torch.nn.Module):
                was = "nothing" if made is None else f"a {type(made).__name__}"
                raise UserError(
                    f"{who}: networks has {was} for {team}, which has agents; give every such team "
                    "a module"
                )
        self._tell_of_other_networks(networks)
        for name, value in tensors.items():
            if not isinstance(value, torch.Tensor):
                raise UserError(
                    f"{who}: tensors() has a {type(value).__name__} in {name}; make it a "
                    "torch.Tensor"
                )

    def _tell_of_other_networks(self, networks: "Mapping[str, MoveNetwork]") -> None:
        from graph_planner import q_network

        classes = {kind: getattr(q_network, name) for kind, name in KINDS.items()}
        wanted = classes[self.weights_kind]
        others = {type(made) for made in networks.values()} - {wanted}
        if not others:
            return
        kinds = [kind for kind, made in classes.items() if others == {made}]
        remedy = f"give weights_kind = {kinds[0]!r}" if kinds else "play them by a ModelPolicy"
        names = ", ".join(sorted(made.__name__ for made in others))
        logger.warning(
            "algorithm %s: its networks are of %s; they train, but by weights_kind %r only weights "
            "of %s are a policy by the name of their file: %s",
            *(type(self).__name__, names, self.weights_kind, wanted.__name__, remedy),
        )

    def checked_row(self, row: Any) -> Row:
        """What `play_round` gave, if it is such a row.

        Raises
        ------
        UserError
            If it is none: nothing, without what `end_round` gives or with other counts, or with
            what is no number.
        """
        who, told = f"algorithm {type(self).__name__}: play_round gave", "self.end_round gives"
        if not isinstance(row, Mapping):
            raise UserError(f"{who} {type(row).__name__}; return what {told}")
        lacking = [name for name in ALWAYS if name not in row]
        if lacking:
            raise UserError(f"{who} a row without {', '.join(lacking)}; return what {told}")
        for name, value in row.items():
            if not isinstance(value, int | float | np.number):
                raise UserError(f"{who} {name} = {value!r:.40}; a row has numbers")
        for name, count in self.come("rounds", "updates").items():
            if row[name] != count:
                raise UserError(
                    f"{who} {name} = {row[name]:g} where self.progress has {count:g}; return what "
                    f"{told}"
                )
        return dict(row)

    def come(self, *names: str) -> Row:
        """How far the run has come, by the names of `Progress`."""
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

    Raises
    ------
    UserError
        If it cannot be written.
    """
    tensors = {
        f"{team}.{name}": value.detach().cpu().contiguous()
        for team, network in trainer.networks.items()
        for name, value in network.state_dict().items()
    }
    notes = tuple(note for ground in trainer.grounds for note in ground.notes)
    header = WeightsHeader(
        trainer.hyperparameters.observation, trainer.shapes, notes, trainer.weights_kind
    )
    save_tensors(path, tensors, header_note(header))
