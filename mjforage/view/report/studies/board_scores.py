"""What the board is read from: scores of every policy on every course, and what sums them up."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mjforage.metrics import normalised, paired_p, resampled_means
from mjforage.metrics.resampling import percentiles
from mjforage.mission.mission_metrics import Description, describe
from mjforage.runs.board import CEILING, FLOOR
from mjforage.view.page import style
from mjforage.view.page.table import Number
from mjforage.view.report.best_marks import LEVEL, best_and_alike
from mjforage.view.report.differences import SEED
from mjforage.view.report.studies.study_logs import Player, StudyLogs

FloatArray = NDArray[np.float64]
SCORES = ("pta_c", "pta_d", "nt50", "nt90", "csr", "energy_per_item")


@dataclass(frozen=True)
class Cell:
    """A course and a score."""

    course: str
    score: str


@dataclass(frozen=True)
class Board:
    """The logs of a study whose variants are courses, each in one world."""

    logs: StudyLogs

    @cached_property
    def courses(self) -> tuple[str, ...]:
        """Names of the courses, in their order."""
        return tuple(self.logs.runs)

    @cached_property
    def policies(self) -> tuple[str, ...]:
        """All who play, in the fixed order."""
        return style.ordered(one for run in self.logs.runs.values() for one in run.policies)

    @cached_property
    def ranked(self) -> tuple[str, ...]:
        """Those of them that are no bounds."""
        return tuple(one for one in self.policies if one not in self.logs.bounds)

    @cached_property
    def metrics(self) -> tuple[Description, ...]:
        """The scores."""
        return tuple(map(describe, SCORES))

    @cached_property
    def shared(self) -> tuple[str, ...]:
        """Courses that every ranked policy plays: means over several are taken over these."""
        return tuple(one for one in self.courses if set(self.ranked) <= set(self.players(one)))

    @cached_property
    def cells(self) -> tuple[Cell, ...]:
        """Every course and score."""
        return tuple(Cell(course, score) for course in self.courses for score in SCORES)

    def world(self, course: str) -> str:
        """World of a course."""
        return str(self.logs.runs[course].worlds[0])

    def players(self, course: str) -> tuple[str, ...]:
        """Who plays a course, in the fixed order."""
        return style.ordered(self.logs.runs[course].policies)

    def player(self, course: str, policy: str) -> Player:
        """A policy on a course."""
        return Player(course, self.world(course), policy)

    def values(self, course: str, policy: str, score: str) -> FloatArray:
        """(episode,) a score, NaN where undefined."""
        return self.logs.values(self.player(course, policy), score)

    def competing(self, cell: Cell) -> dict[str, FloatArray]:
        """Ranked policies of a course -> (episode,) the score."""
        players = [one for one in self.players(cell.course) if one in self.ranked]
        return {one: self.values(cell.course, one, cell.score) for one in players}

    def winners(self, cell: Cell) -> set[str]:
        """The best there, and those not told from it."""
        return best_and_alike(self.competing(cell), describe(cell.score).better)

    @cached_property
    def _began(self) -> dict[tuple[str, str, str], float]:
        """Call, worker and policy -> when its first chunk of that policy began."""
        found: dict[tuple[str, str, str], float] = {}
        for one in (cost for costs in self.logs.costs.values() for cost in costs):
            key = (one.started, one.worker, one.policy)
            found[key] = min(one.began_s, found.get(key, one.began_s))
        return found

    def decision(self, course: str, policy: str) -> "Decision":
        """CPU time of the policy per decision for the whole fleet.

        A worker's first chunk of a policy also loads and compiles: it counts where there is no
        other alone.
        """
        world = self.world(course)
        chunks = [c for c in self.logs.costs[course] if (c.world, c.policy) == (world, policy)]
        began = self._began
        warm = [c for c in chunks if c.began_s > began[c.started, c.worker, c.policy]]
        decisions = sum(one.decisions for one in warm or chunks)
        if not decisions:
            return Decision(np.nan)
        return Decision(1000 * sum(one.decide_s for one in warm or chunks) / decisions, not warm)

    def mean_decision(self, policy: str) -> "Decision":
        """Geometric mean of the same over the courses that all play, those that were warm if any.

        Undefined if one of them was not measured.
        """
        found = [self.decision(course, policy) for course in self.shared]
        used = [one for one in found if not one.at_most] or found
        each = np.array([one.ms for one in used])
        if not each.size or not (each > 0).all():
            return Decision(np.nan)
        return Decision(float(np.exp(np.log(each).mean())), used[0].at_most)


@dataclass(frozen=True)
class Decision:
    """CPU time of a decision for the whole fleet."""

    ms: float  # NaN if not measured
    at_most: bool = False  # loading and compiling are in it


def draws_of(board: Board, course: str) -> FloatArray:
    """(policy, score, 1 + resample) means on a course: of its episodes, then of resampled ones.

    Policies of the board in their order, NaN for those that do not play it; all play the same
    resampled episodes.
    """
    playing = board.players(course)
    nothing = np.full(board.logs.runs[course].episodes, np.nan)
    values = np.array(
        [
            [board.values(course, p, key) if p in playing else nothing for key in SCORES]
            for p in board.policies
        ]
    )
    again = resampled_means(values, [SEED, board.courses.index(course)])
    once = plain_means(values)
    return np.concatenate([once[..., None], again], axis=-1)


def plain_means(values: FloatArray) -> FloatArray:
    """(..., episode) -> (...) means of the defined episodes, NaN without one."""
    defined = ~np.isnan(values)
    total, number = np.nansum(values, axis=-1), defined.sum(axis=-1)
    return np.where(number > 0, total / np.maximum(number, 1), np.nan)


@dataclass(frozen=True)
class Standing:
    """Means over courses, with intervals of resampled episodes; every array is (..., 1 + resample),
    of which the first is the estimate.

    Attributes
    ----------
    board : whose courses they are
    raw : (policy, score, ...) mean over the courses that all play
    scores : (policy, score, ...) the same of normalised scores, over the cells that have one
    overall : (policy, ...) mean over all those cells
    used : the cells that have a normalised score
    """

    board: Board
    raw: FloatArray
    scores: FloatArray
    overall: FloatArray
    used: tuple[Cell, ...]

    @classmethod
    def of(cls, board: Board) -> "Standing":
        """Sum a board up."""
        shape = (len(board.policies), len(SCORES), 0)
        draws = {course: draws_of(board, course) for course in board.shared}
        used = tuple(one for one in board.cells if one.course in draws and _told(board, one))
        raw = np.array(list(draws.values())).mean(axis=0) if draws else np.full(shape, np.nan)
        scaled = {cell: _scaled(board, draws[cell.course], cell) for cell in used}
        by_score = [
            [found for cell, found in scaled.items() if cell.score == score] for score in SCORES
        ]
        nothing = np.full((len(board.policies), raw.shape[-1]), np.nan)
        scores = np.array([np.mean(one, axis=0) if one else nothing for one in by_score])
        overall = np.mean(list(scaled.values()), axis=0) if scaled else nothing
        return cls(board, raw, scores.swapaxes(0, 1), overall, used)

    def number(self, row: FloatArray) -> Number:
        """An estimate with its interval, from one (1 + resample) of the arrays."""
        if not row.size or np.isnan(row).any():
            return Number(float(row[0]) if row.size else np.nan)
        return Number(float(row[0]), *percentiles(row[1:]))


def _told(board: Board, cell: Cell) -> bool:
    """Whether the ceiling is better than the floor there, by a paired t-test at the usual level."""
    if not {FLOOR, CEILING} <= set(board.players(cell.course)):
        return False
    low, high = (board.values(cell.course, one, cell.score) for one in (FLOOR, CEILING))
    gap = describe(cell.score).better * plain_means(high - low)
    return bool(gap > 0 and paired_p(high, low) < LEVEL)


def _scaled(board: Board, draws: FloatArray, cell: Cell) -> FloatArray:
    """(policy, 1 + resample) normalised means of a cell."""
    means = draws[:, SCORES.index(cell.score)]
    low, high = (means[board.policies.index(one)] for one in (FLOOR, CEILING))
    return normalised(means, low, high)


def mean_ranks(board: Board) -> dict[str, float]:
    """Ranked policy -> mean over its cells of its rank by the mean, ties sharing theirs.

    The rank in a cell is 1 + the policies that are better + half of the others that are equal.
    """
    ranks: dict[str, list[float]] = {policy: [] for policy in board.ranked}
    for cell in board.cells:
        better = describe(cell.score).better
        means = {p: better * float(plain_means(x)) for p, x in board.competing(cell).items()}
        known = {policy: mean for policy, mean in means.items() if not np.isnan(mean)}
        for policy, mean in known.items():
            above = sum(other > mean for other in known.values())
            equal = sum(other == mean for other in known.values()) - 1
            ranks[policy].append(1 + above + equal / 2)
    return {policy: float(np.mean(found)) if found else np.nan for policy, found in ranks.items()}
