"""Scores of every policy on every task of the leaderboard, and their summaries."""

from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.stats import rankdata

from mjforage.metrics import normalised, resampled_means
from mjforage.metrics.resampling import percentiles
from mjforage.mission.scoring import Description, describe
from mjforage.runs.costs import Cost
from mjforage.runs.studies.board import CEILING, FLOOR
from mjforage.view.page import style
from mjforage.view.page.table import Number
from mjforage.view.report.best_marks import best_and_alike
from mjforage.view.report.differences import SEED, estimates
from mjforage.view.report.run_logs import Case, FloatArray, policy_name
from mjforage.view.report.studies.study_logs import StudyLogs, ordered_policies

SCORES = ("pta_c", "pta_d", "nt50", "nt90", "csr", "energy_per_item")
TaskScore = tuple[str, str]
"""A task and the key of a score."""


@dataclass(frozen=True)
class Decision:
    """CPU time of a decision for the whole fleet."""

    ms: float  # NaN if not measured
    at_most: bool = False  # loading and compiling are in it


@dataclass(frozen=True)
class Board:
    """The logs of a study whose variants are tasks, each in one world."""

    logs: StudyLogs

    @cached_property
    def tasks(self) -> tuple[str, ...]:
        """Names of the tasks, in their order."""
        return tuple(self.logs.runs)

    @cached_property
    def policies(self) -> tuple[str, ...]:
        """All policies, in the fixed order."""
        return ordered_policies(self.logs)

    @cached_property
    def ranked(self) -> tuple[str, ...]:
        """Policies that are no oracle bounds, in the fixed order."""
        return tuple(one for one in self.policies if one not in self.logs.bounds)

    @cached_property
    def metrics(self) -> tuple[Description, ...]:
        """The scores."""
        return tuple(map(describe, SCORES))

    @cached_property
    def shared(self) -> tuple[str, ...]:
        """Tasks that every ranked policy plays: means over several are taken over these."""
        return tuple(one for one in self.tasks if set(self.ranked) <= set(self.players(one)))

    @cached_property
    def cells(self) -> tuple[TaskScore, ...]:
        """Every task and score."""
        return tuple((task, score) for task in self.tasks for score in SCORES)

    def head(self, policy: str) -> str:
        """A policy, marked where it is a bound."""
        return policy_name(policy, self.logs.bounds)

    def colour(self, policy: str) -> str:
        """Colour of a policy."""
        return style.policy_styles(self.policies)[policy].colour

    def players(self, task: str) -> tuple[str, ...]:
        """Policies of a task, in the fixed order."""
        return self.logs.runs[task].policies

    def case(self, task: str, policy: str) -> Case:
        """A policy on a task."""
        run = self.logs.runs[task]
        return Case(run, run.run.worlds[0], policy)

    def competing(self, cell: TaskScore) -> dict[str, FloatArray]:
        """Ranked policies of a task -> (episode,) the score."""
        task, score = cell
        players = [one for one in self.players(task) if one in self.ranked]
        return {one: self.case(task, one).values(score) for one in players}

    @cached_property
    def winners(self) -> dict[TaskScore, set[str]]:
        """The best of every cell, and those not significantly different from it."""
        return {
            cell: best_and_alike(self.competing(cell), describe(cell[1]).better)
            for cell in self.cells
        }

    def told(self, cell: TaskScore) -> bool:
        """True if some policy is told from the best of a cell."""
        known = sum(bool(np.isfinite(x).any()) for x in self.competing(cell).values())
        return 0 < len(self.winners[cell]) < known

    @cached_property
    def _later(self) -> set[Cost]:
        """Chunks that are not a worker's first of a policy in a call: that loads and compiles."""
        own: dict[tuple[str, str, str], list[Cost]] = defaultdict(list)
        for one in (cost for costs in self.logs.costs.values() for cost in costs):
            own[one.started, one.worker, one.policy].append(one)
        return {
            one
            for several in own.values()
            for one in several
            if one.began_s > min(each.began_s for each in several)
        }

    def decision(self, task: str, policy: str) -> Decision:
        """CPU time of the policy per decision for the whole fleet.

        A worker's first chunk of a policy counts where there is no other alone.
        """
        world = self.case(task, policy).world
        chunks = [c for c in self.logs.costs[task] if (c.world, c.policy) == (world, policy)]
        warm = [chunk for chunk in chunks if chunk in self._later]
        decisions = sum(one.decisions for one in warm or chunks)
        if not decisions:
            return Decision(np.nan)
        return Decision(1000 * sum(one.decide_s for one in warm or chunks) / decisions, not warm)

    def mean_decision(self, policy: str) -> Decision:
        """Geometric mean of the same over the tasks that all play, those that were warm if any.

        Undefined if one of them was not measured.
        """
        found = [self.decision(task, policy) for task in self.shared]
        used = [one for one in found if not one.at_most] or found
        each = np.array([one.ms for one in used])
        if not each.size or not (each > 0).all():
            return Decision(np.nan)
        return Decision(float(np.exp(np.log(each).mean())), used[0].at_most)


def draws_of(board: Board, task: str) -> FloatArray:
    """(policy, score, 1 + resample) means on a task: of its episodes, then of resampled ones.

    Policies of the board in their order, NaN for those that do not play it; all play the same
    resampled episodes.
    """
    nothing = np.full((len(SCORES), board.logs.runs[task].run.episodes), np.nan)
    values = np.array(
        [
            [board.case(task, one).values(key) for key in SCORES]
            if one in board.players(task)
            else nothing
            for one in board.policies
        ]
    )
    again = resampled_means(values, [SEED, board.tasks.index(task)])
    return np.concatenate([plain_means(values)[..., None], again], axis=-1)


def plain_means(values: FloatArray) -> FloatArray:
    """(..., episode) -> (...) means of the defined episodes, NaN without one."""
    defined = ~np.isnan(values)
    total, number = np.nansum(values, axis=-1), defined.sum(axis=-1)
    return np.where(number > 0, total / np.maximum(number, 1), np.nan)


@dataclass(frozen=True)
class Standing:
    """Means over tasks, with intervals of resampled episodes; every array is (..., 1 + resample),
    of which the first is the estimate.

    Attributes
    ----------
    board : whose tasks they are
    raw : (policy, score, ...) mean over the tasks that all play
    scores : (policy, score, ...) the same of normalised scores, over the cells that have one
    overall : (policy, ...) mean over all those cells
    used : the cells that have a normalised score
    """

    board: Board
    raw: FloatArray
    scores: FloatArray
    overall: FloatArray
    used: tuple[TaskScore, ...]

    @classmethod
    def of(cls, board: Board) -> "Standing":
        """Sum a board up."""
        draws = {task: draws_of(board, task) for task in board.shared}
        used = tuple(cell for cell in board.cells if cell[0] in draws and _told(board, cell))
        shape = (len(board.policies), len(SCORES), 0)
        raw = np.array(list(draws.values())).mean(axis=0) if draws else np.full(shape, np.nan)
        scaled = {cell: _scaled(board, draws[cell[0]], cell[1]) for cell in used}
        nothing = np.full((len(board.policies), raw.shape[-1]), np.nan)
        scores = [[found for (_, score), found in scaled.items() if score == key] for key in SCORES]
        means = np.array([np.mean(one, axis=0) if one else nothing for one in scores])
        overall = np.mean(list(scaled.values()), axis=0) if scaled else nothing
        return cls(board, raw, means.swapaxes(0, 1), overall, used)

    @property
    def normalised(self) -> list[str]:
        """Scores that have a normalised one in some cell."""
        return [key for key in SCORES if any(score == key for _, score in self.used)]

    @staticmethod
    def number(row: FloatArray) -> Number:
        """An estimate with its interval, from one (1 + resample) of the arrays."""
        if not row.size or np.isnan(row).any():
            return Number(float(row[0]) if row.size else np.nan)
        return Number(float(row[0]), *percentiles(row[1:]))


def _told(board: Board, cell: TaskScore) -> bool:
    """True if the ceiling is better than the floor there, with 0 outside its interval."""
    task, score = cell
    if not {FLOOR, CEILING} <= set(board.players(task)):
        return False
    low, high = (board.case(task, one).values(score) for one in (FLOOR, CEILING))
    (found,) = estimates([(describe(score).better * (high - low), 0)])
    return found.apart and found.value > 0


def _scaled(board: Board, draws: FloatArray, score: str) -> FloatArray:
    """(policy, 1 + resample) normalised means of a cell."""
    means = draws[:, SCORES.index(score)]
    low, high = (means[board.policies.index(one)] for one in (FLOOR, CEILING))
    return normalised(means, low, high)


def mean_ranks(board: Board) -> dict[str, float]:
    """Ranked policy -> mean over its cells of its rank by the mean, ties sharing theirs.

    The rank in a cell is 1 + the policies that are better + half of the others that are equal.
    """
    ranks: dict[str, list[float]] = {policy: [] for policy in board.ranked}
    for cell in board.cells:
        means = {policy: float(plain_means(x)) for policy, x in board.competing(cell).items()}
        known = {policy: mean for policy, mean in means.items() if not np.isnan(mean)}
        better = describe(cell[1]).better
        places = rankdata([-better * mean for mean in known.values()])
        for policy, place in zip(known, places, strict=True):
            ranks[policy].append(float(place))
    return {policy: float(np.mean(found)) if found else np.nan for policy, found in ranks.items()}
