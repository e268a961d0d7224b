"""The training loop: rounds of whole episodes side by side, with updates in between.

A run can be stopped and resumed between rounds, when no episode is under way; the same rounds give
the same weights whatever happened between them.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from graph_planner.encodings import Shapes, encoder_label
from graph_planner.policies.ddqn import QPolicy
from graph_planner.policies.registry import check_policies
from graph_planner.randomness import episode_keys
from graph_planner.task import Task
from graph_planner.weights import TEAMS, WeightsHeader, header_note
from mjforage.core.errors import UserError
from mjforage.core.mission_metrics import METRICS, Scorer
from mjforage.core.scenario import Scenario
from mjforage.core.schema import OPEN
from mjforage.core.sizes import check_memory
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.environments.rewards import labelled
from mjforage.learning.training.families import ground_on
from mjforage.learning.training.files import save_tensors
from mjforage.learning.training.grounds import Ground, common_shapes
from mjforage.learning.training.hyperparameters import Hyperparameters
from mjforage.learning.training.initial_weights import begin_with
from mjforage.learning.training.learner import Learner
from mjforage.learning.training.replay_memory import FINAL, NOTHING, PLAYED, memory_bytes
from mjforage.learning.training.rounds import Played
from mjforage.physics.worlds import create_mission

if TYPE_CHECKING:
    from graph_planner.q_network import DuelingNetwork

HELD_OUT = 1 << 40  # seed of evaluation episodes; training seeds are smaller
SCORES = ("pta_d", "pta_c", "nt50", "nt90", "csr", "rmse_columns", "length")

Row = dict[str, float]


class LearnersPolicy(QPolicy):
    """The networks of a run in training, without exploration."""

    def __init__(self, networks: "dict[str, DuelingNetwork]", encoding: str) -> None:
        self._header = WeightsHeader(encoding, {})
        self._trained = networks

    def _load(self, task: Task) -> "dict[str, DuelingNetwork]":
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


class Trainer:
    """One training run.

    Attributes
    ----------
    hyperparameters, seed, device : as given
    setup : of the first scenario
    grounds : the scenarios; rounds take them in turn
    shapes : of one agent's pictures
    round : the one under way
    learners : team of `TEAMS` -> its learner; a team without agents has none
    progress : how far it has come
    clock : where the time went
    """

    def __init__(
        self,
        scenarios: Sequence[Scenario],
        hyperparameters: Hyperparameters,
        seed: int = 0,
        device: str = "cpu",
    ) -> None:
        """Prepare a run.

        Parameters
        ----------
        scenarios : rounds take them in turn; evaluations are of the first

        Raises
        ------
        UserError
            If a scenario, a setting or the seed is not valid, or fleets or arrays differ.
        """
        if not 0 <= seed < HELD_OUT:
            raise UserError(f"seed {seed}: out of range; give 0 to {HELD_OUT - 1}")
        if hyperparameters.teacher:
            teacher = check_policies([hyperparameters.teacher])[0]
            hyperparameters = replace(hyperparameters, teacher=teacher)
        hyperparameters = replace(
            hyperparameters,
            observation=encoder_label(hyperparameters.observation),
            reward=labelled(hyperparameters.reward),
        )
        self.hyperparameters, self.seed, self.device = hyperparameters, seed, device
        home = self._ground(scenarios[0])
        self.setup = home.setup
        self.grounds = [home, *(ground_on(each, self._ground) for each in scenarios[1:])]
        self.shapes = common_shapes([each for ground in self.grounds for each in ground.examples])
        fleet = self.setup.fleet
        self.agents = dict(zip(TEAMS, (fleet.discoverers, fleet.collectors), strict=True))
        _check_memory(self.shapes, self.agents, hyperparameters)
        self.learners = {
            team: Learner(
                self.shapes,
                hyperparameters.num_envs * ids.size,
                hyperparameters,
                seed + i,
                device,
            )
            for i, (team, ids) in enumerate(self.agents.items())
            if ids.size
        }
        if hyperparameters.initial:
            begin_with(self.learners, hyperparameters, self.setup.task)
        self.random = np.random.Generator(np.random.PCG64(seed))
        self.progress, self.clock = Progress(), Clock()
        self._booked = time.perf_counter()

    def _ground(self, scenario: Scenario) -> Ground:
        told = self.hyperparameters
        options = EnvironmentOptions(scenario, told.world, told.observation, told.reward)
        return Ground(options, told.num_envs, told.vary)

    @property
    def networks(self) -> "dict[str, DuelingNetwork]":
        """Team -> network to use: the target, a moving average, steadier than the online one."""
        return {team: learner.target for team, learner in self.learners.items()}

    def book_time(self) -> None:
        """Add the time since the last call, or since this process began, to the run's."""
        now = time.perf_counter()
        self.progress.seconds += now - self._booked
        self._booked = now

    def play_round(self) -> Row:
        """Play one episode in every sub-environment to its end, and learn on the way."""
        progress, num_envs = self.progress, self.hyperparameters.num_envs
        numbers = np.arange(progress.episodes, progress.episodes + num_envs)
        keys = episode_keys(self.seed, numbers)
        turn, number = divmod(progress.rounds, len(self.grounds))
        self.round = self.grounds[number].round(keys, turn)
        self.round.start(keys)
        taught = self._teach()
        returns = np.zeros((num_envs, self.round.agents))
        learned: list[dict[str, float]] = []
        while self.round.active.any():
            outcome = self._step(taught)
            returns += outcome.rewards
            learned += self._learn()
        self._open(np.where(self._present, FINAL, NOTHING))
        for learner in self.learners.values():
            learner.memory.finish()
        progress.rounds += 1
        progress.episodes += num_envs
        progress.decisions += int(self.round.steps.sum())
        self.book_time()
        return self._row(returns, learned)

    def _row(self, returns: NDArray[np.float64], learned: list[dict[str, float]]) -> Row:
        row: Row = {
            **self._come("rounds", "episodes", "updates", "seconds"),
            "explore": self._explore,
            "pta_c": 100.0 * self.round.collected,
            "length": float(self.round.steps.mean()),
        }
        for team, ids in self.agents.items():
            if ids.size:
                row[f"return_{team}"] = float(returns[:, ids].mean())
        for name in ("loss", "value", "error"):
            found = [entry[name] for entry in learned]
            row[name] = float(np.mean(found)) if found else float("nan")
        return row

    def _come(self, *names: str) -> Row:
        """How far the run has come, by the names of `Progress`."""
        return {name: float(getattr(self.progress, name)) for name in names}

    def _teach(self) -> NDArray[np.bool_] | None:
        """The sub-environments (env,) that the teacher plays; None once its time is over."""
        hyperparameters, left = self.hyperparameters, 0.0
        if hyperparameters.teacher and self.progress.updates < hyperparameters.teacher_updates:
            left = 1.0 - self.progress.updates / hyperparameters.teacher_updates
        taught = self.random.random(hyperparameters.num_envs) < left
        if left == 0.0:
            return None
        self.round.teach(hyperparameters.teacher)
        return taught

    def _step(self, taught: NDArray[np.bool_] | None) -> Played:
        clock = self.clock
        self._present = self.round.active.copy()
        self._open(np.where(self._present, PLAYED, NOTHING))
        preferences = self._preferences()
        shown = np.zeros(preferences.shape, np.bool_)
        if taught is not None:
            theirs, shown = clock("teacher", self.round.shown)
            preferences[taught] = theirs[taught]
        outcome: Played = clock("environment", lambda: self.round.play(preferences))
        for team, learner in self.learners.items():
            ids = self.agents[team]
            learner.memory.close(
                outcome.taken[:, ids].reshape(-1).astype(np.int64),
                shown[:, ids].reshape(-1, 9),
                outcome.rewards[:, ids].reshape(-1),
                np.repeat(outcome.terminated, ids.size),
            )
        return outcome

    def _open(self, kind: NDArray[np.int64]) -> None:
        """Show the learners what there is now, kind (env,) of row."""
        envs = np.flatnonzero(kind != NOTHING)
        self._levels = self.clock("environment", lambda: self.round.see(envs))
        self._legal = self.round.masks.astype(np.bool_)
        for team, learner in self.learners.items():
            ids = self.agents[team]
            levels = {n: v[:, ids].reshape(-1, *v.shape[2:]) for n, v in self._levels.items()}
            rows = np.repeat(kind, ids.size).astype(np.uint8)
            legal = self._legal[:, ids].reshape(-1, 9)
            self.clock("replay", partial(learner.memory.open, levels, legal, rows))

    @property
    def _explore(self) -> float:
        """Share of random moves now."""
        hyperparameters = self.hyperparameters
        part = min(1.0, self.progress.updates / hyperparameters.explore_updates)
        return hyperparameters.explore_from + part * (
            hyperparameters.explore_to - hyperparameters.explore_from
        )

    def _preferences(self) -> NDArray[np.float64]:
        """(env, agent, 9) values, or random numbers where a move is explored."""
        shape = (self.round.num_envs, self.round.agents)
        explored = self.random.random(shape) < self._explore
        preferences = self.random.random((*shape, 9))
        for team, learner in self.learners.items():
            ids = self.agents[team]
            wanted = self._present[:, None] & ~explored[:, ids]
            env, number = np.nonzero(wanted)
            if env.size:
                levels = {name: v[env, ids[number]] for name, v in self._levels.items()}
                preferences[env, ids[number]] = self.clock(
                    "network", partial(learner.values, levels)
                )
        return preferences

    def _learn(self) -> list[dict[str, float]]:
        """The updates that this step has earned."""
        hyperparameters, progress = self.hyperparameters, self.progress
        learners = self.learners.values()
        if not all(learner.memory.warm(hyperparameters.warmup) for learner in learners):
            return []
        progress.due += hyperparameters.updates_per_step * float(self._present.mean())
        learned = []
        beta = hyperparameters.correction + (1.0 - hyperparameters.correction) * min(
            1.0, progress.updates / (10 * hyperparameters.explore_updates)
        )
        while progress.due >= 1.0:
            progress.due -= 1.0
            progress.updates += 1
            learned += [self.update(learner, beta) for learner in learners]
        return learned

    def update(self, learner: Learner, beta: float) -> dict[str, float]:
        """Draw, learn, and put the new priorities back."""
        replay, hyperparameters, clock = learner.memory, self.hyperparameters, self.clock
        batch = clock("replay", lambda: replay.draw(hyperparameters.batch, beta, self.random))
        facts, errors = clock("network", lambda: learner.learn(batch))
        clock("replay", lambda: replay.reprioritise(batch.rows, errors, hyperparameters.priority))
        return dict(facts)

    def evaluate(self) -> Row:
        """Scores on held-out episodes, without exploration; `rank` is better when lower."""
        setup, hyperparameters = self.setup, self.hyperparameters
        mission = create_mission(setup, hyperparameters.world)
        mission.reset(HELD_OUT, np.arange(hyperparameters.evaluate_episodes))
        scorer = Scorer(mission, [METRICS.find(key) for key in SCORES])
        mission.run(LearnersPolicy(self.networks, hyperparameters.observation), (scorer,))
        scores = scorer.scores().scalars
        row = {name: _mean(scores[name]) for name in SCORES}
        row["rank"] = row["nt50"] + row["nt90"] + (100.0 - row["pta_c"]) / 20.0
        self.book_time()
        return self._come("rounds", "updates", "seconds") | row


def _check_memory(
    shapes: Shapes, agents: dict[str, NDArray[np.int64]], chosen: Hyperparameters
) -> None:
    """Refuse replays that do not fit into this machine."""
    wanted = sum(
        memory_bytes(shapes, chosen.num_envs * ids.size, chosen.capacity, chosen.n_step)
        for ids in agents.values()
        if ids.size
    )
    check_memory(
        f"--learning: a replay of capacity = {chosen.capacity} for each team, with num_envs = "
        f"{chosen.num_envs},",
        wanted,
        "give less capacity, or fewer environments",
    )


def _mean(values: NDArray[np.float64]) -> float:
    """Mean of the defined values; NaN without any."""
    defined = values[np.isfinite(values)]
    return float(defined.mean()) if defined.size else float("nan")


def save_weights(trainer: Trainer, path: Path) -> None:
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
    header = WeightsHeader(trainer.hyperparameters.observation, trainer.shapes, notes)
    save_tensors(path, tensors, header_note(header))
