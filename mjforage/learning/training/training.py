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

from graph_planner.policies import Policy, create_policy
from graph_planner.policies.ddqn import QPolicy
from graph_planner.policies.registry import check_policies
from graph_planner.randomness import episode_keys
from graph_planner.task import Task
from graph_planner.weights import TEAMS, WeightsHeader, ground_note, header_note
from mjforage.core.episode_log import EpisodeLog
from mjforage.core.errors import UserError
from mjforage.core.mission import Mission
from mjforage.core.scenario import Scenario
from mjforage.core.scoring import score
from mjforage.learning.environments.choice import Choice
from mjforage.learning.environments.game import Game, Outcome
from mjforage.learning.training.ddqn import Learner
from mjforage.learning.training.files import save_tensors
from mjforage.learning.training.replay import FINAL, NOTHING, PLAYED
from mjforage.learning.training.settings import Settings

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
    settings, seed, device : as given
    games : of the scenarios; rounds take them in turn
    game : that of the round under way
    learners : team of `TEAMS` -> its learner; a team without agents has none
    progress : how far it has come
    clock : where the time went
    """

    def __init__(
        self,
        scenarios: Sequence[Scenario],
        settings: Settings,
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
        if settings.teacher:
            teacher = check_policies([settings.teacher])[0]
            settings = replace(settings, teacher=teacher)
        self.settings, self.seed, self.device = settings, seed, device
        choices = [
            Choice(scenario, observation=settings.observation, reward=settings.reward)
            for scenario in scenarios
        ]
        self.games = [Game(choice, settings.lanes) for choice in choices]
        self.game = self.games[0]
        fleet = self.game.setup.fleet
        _check_alike(self.games)
        self.agents = dict(zip(TEAMS, (fleet.discoverers, fleet.collectors), strict=True))
        self.learners = {
            team: Learner(self.game.shapes, settings.lanes * ids.size, settings, seed + i, device)
            for i, (team, ids) in enumerate(self.agents.items())
            if ids.size
        }
        self.random = np.random.Generator(np.random.PCG64(seed))
        self.progress, self.clock = Progress(), Clock()
        self._booked = time.perf_counter()

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
        """Play one episode in every lane to its end, and learn on the way."""
        progress, lanes = self.progress, self.settings.lanes
        numbers = np.arange(progress.episodes, progress.episodes + lanes)
        keys = episode_keys(self.seed, numbers)
        self.game = game = self.games[progress.rounds % len(self.games)]
        game.start(np.arange(lanes), keys)
        teacher, taught = self._teacher(keys)
        returns = np.zeros((lanes, game.agents))
        learned: list[dict[str, float]] = []
        while game.mission.active.any():
            outcome = self._step(teacher, taught)
            returns += outcome.rewards
            learned += self._learn()
        self._open(np.where(self._present, FINAL, NOTHING))
        for learner in self.learners.values():
            learner.replay.finish()
        progress.rounds += 1
        progress.episodes += lanes
        progress.decisions += int(game.mission.step.sum())
        self.book_time()
        return self._row(returns, learned)

    def _row(self, returns: NDArray[np.float64], learned: list[dict[str, float]]) -> Row:
        known, total = self.game.mission.model.knowledge, self.game.n_items.sum()
        row: Row = {
            **self._come("rounds", "episodes", "updates", "seconds"),
            "explore": self._explore,
            "pta_c": 100.0 * float((known.t_collected >= 0).sum() / total),
            "length": float(self.game.mission.step.mean()),
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

    def _teacher(self, keys: NDArray[np.uint64]) -> tuple[Policy | None, NDArray[np.bool_]]:
        """The teacher while there is one, and the lanes that it plays."""
        settings, left = self.settings, 0.0
        if settings.teacher and self.progress.updates < settings.teacher_updates:
            left = 1.0 - self.progress.updates / settings.teacher_updates
        taught = self.random.random(settings.lanes) < left
        if left == 0.0:
            return None, taught
        teacher = create_policy(settings.teacher)
        teacher.reset(self.game.setup.task, keys)
        return teacher, taught

    def _step(self, teacher: Policy | None, taught: NDArray[np.bool_]) -> Outcome:
        game, clock = self.game, self.clock
        self._present = game.mission.active.copy()
        self._open(np.where(self._present, PLAYED, NOTHING))
        preferences = self._preferences()
        shown = np.zeros(preferences.shape, np.bool_)
        if teacher is not None:
            theirs = clock("teacher", lambda: game.mission.ask(teacher))
            move = game.mission.decide(theirs).direction[..., None].astype(np.int64)
            shown[:] = theirs >= np.take_along_axis(theirs, move, axis=-1)
            preferences[taught] = theirs[taught]
        outcome: Outcome = clock("environment", lambda: game.play(preferences))
        for team, learner in self.learners.items():
            ids = self.agents[team]
            learner.replay.close(
                outcome.taken[:, ids].reshape(-1).astype(np.int64),
                shown[:, ids].reshape(-1, 9),
                outcome.rewards[:, ids].reshape(-1),
                np.repeat(outcome.terminated, ids.size),
            )
        return outcome

    def _open(self, kind: NDArray[np.int64]) -> None:
        """Show the learners what there is now, kind (lane,) of row."""
        lanes = np.flatnonzero(kind != NOTHING)
        self._levels = self.clock("environment", lambda: self.game.see(lanes))
        self._legal = self.game.masks.astype(np.bool_)
        for team, learner in self.learners.items():
            ids = self.agents[team]
            levels = {n: v[:, ids].reshape(-1, *v.shape[2:]) for n, v in self._levels.items()}
            rows = np.repeat(kind, ids.size).astype(np.uint8)
            legal = self._legal[:, ids].reshape(-1, 9)
            self.clock("replay", partial(learner.replay.open, levels, legal, rows))

    @property
    def _explore(self) -> float:
        """Share of random moves now."""
        settings = self.settings
        part = min(1.0, self.progress.updates / settings.explore_updates)
        return settings.explore_from + part * (settings.explore_to - settings.explore_from)

    def _preferences(self) -> NDArray[np.float64]:
        """(lane, agent, 9) values, or random numbers where a move is explored."""
        game = self.game
        shape = (game.lanes, game.agents)
        explored = self.random.random(shape) < self._explore
        preferences = self.random.random((*shape, 9))
        for team, learner in self.learners.items():
            ids = self.agents[team]
            wanted = self._present[:, None] & ~explored[:, ids]
            lane, number = np.nonzero(wanted)
            if lane.size:
                levels = {name: v[lane, ids[number]] for name, v in self._levels.items()}
                preferences[lane, ids[number]] = self.clock(
                    "network", partial(learner.values, levels)
                )
        return preferences

    def _learn(self) -> list[dict[str, float]]:
        """The updates that this step has earned."""
        settings, progress = self.settings, self.progress
        learners = self.learners.values()
        if not all(learner.replay.warm(settings.warmup) for learner in learners):
            return []
        progress.due += settings.updates_per_step * float(self._present.mean())
        learned = []
        beta = settings.correction + (1.0 - settings.correction) * min(
            1.0, progress.updates / (10 * settings.explore_updates)
        )
        while progress.due >= 1.0:
            progress.due -= 1.0
            progress.updates += 1
            learned += [self.update(learner, beta) for learner in learners]
        return learned

    def update(self, learner: Learner, beta: float) -> dict[str, float]:
        """Draw, learn, and put the new priorities back."""
        replay, settings, clock = learner.replay, self.settings, self.clock
        batch = clock("replay", lambda: replay.draw(settings.batch, beta, self.random))
        facts, errors = clock("network", lambda: learner.learn(batch))
        clock("replay", lambda: replay.reprioritise(batch.rows, errors, settings.priority))
        return dict(facts)

    def evaluate(self) -> Row:
        """Scores on held-out episodes, without exploration; `rank` is better when lower."""
        setup, settings = self.games[0].setup, self.settings
        mission = Mission(setup)
        mission.reset(HELD_OUT, np.arange(settings.evaluate_episodes))
        log = EpisodeLog(mission)
        mission.run(LearnersPolicy(self.networks, settings.observation), (log,))
        scores = score(log, setup.fleet, setup.scenario.horizon).scalars
        row = {name: _mean(scores[name]) for name in SCORES}
        row["rank"] = row["nt50"] + row["nt90"] + (100.0 - row["pta_c"]) / 20.0
        self.book_time()
        return self._come("rounds", "updates", "seconds") | row


def _check_alike(games: Sequence[Game]) -> None:
    """Refuse scenarios that cannot share networks and replays."""
    first, *others = [(game.setup.fleet.collects.tolist(), game.shapes) for game in games]
    for number, other in enumerate(others, start=1):
        if other != first:
            names = [games[i].setup.scenario.name for i in (0, number)]
            raise UserError(
                f"scenarios {names[0]} and {names[1]}: fleets or arrays differ; train together "
                "scenarios with as many scouts and foragers, on the egocentric observation"
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
    grounds = tuple(ground_note(game.setup.task) for game in trainer.games)
    header = WeightsHeader(trainer.settings.observation, trainer.game.shapes, grounds)
    save_tensors(path, tensors, header_note(header))
