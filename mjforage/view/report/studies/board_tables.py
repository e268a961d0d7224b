"""Tables of the board: each course, its middle half, differences to the best, and all together."""

import numpy as np

from mjforage.metrics import bootstrap, iqm
from mjforage.mission.mission_metrics import describe
from mjforage.view.page import style
from mjforage.view.page.figure import joined
from mjforage.view.page.table import NOTHING, Number, Row, Table
from mjforage.view.report.best_marks import FEWEST, LEVEL, against_best, best
from mjforage.view.report.differences import SEED, Difference, p_text
from mjforage.view.report.studies.board_scores import (
    SCORES,
    Board,
    Cell,
    Decision,
    Standing,
    mean_ranks,
)
from mjforage.view.report.text_tables import (
    in_full,
    in_minutes,
    number,
    plus_minus,
    policy_name,
)

DECISION = "Decision"
DECISION_UNIT = "ms of CPU"
BEST = "best"
MARKED = (
    "Bold: the best mean of the column and those that cannot be told from it (paired t-tests with "
    f"the best over the same episodes at the level {LEVEL:g}, corrected by Holm's method for the "
    f"policies of the course, {FEWEST} episodes or more; bounds aside; none where all are alike)."
)


def _colour(board: Board, policy: str) -> str:
    return style.policy_styles(board.policies)[policy].colour


def _head(board: Board, policy: str) -> str:
    return policy_name(policy, board.logs.bounds)


def _columns(board: Board) -> tuple[tuple[str, ...], tuple[str, ...], tuple[int, ...]]:
    """Labels, units and directions of the scores."""
    found = board.metrics
    labels, units = tuple(m.label for m in found), tuple(m.unit for m in found)
    return labels, units, tuple(m.better for m in found)


def time_cell(spent: Decision) -> str:
    """Three digits of a time of any size; an upper bound where loading is in it."""
    if np.isnan(spent.ms):
        return NOTHING
    digits = max(0, 2 - int(np.floor(np.log10(spent.ms)))) if spent.ms > 0 else 0
    return ("≤ " if spent.at_most else "") + number(spent.ms, digits)


def course_table(board: Board, course: str) -> Table:
    """Means of every score on a course, and the time of a decision."""
    winners = [board.winners(Cell(course, key)) for key in SCORES]
    rows = []
    for policy in board.players(course):
        entries = [board.logs.entry(board.player(course, policy), key) for key in SCORES]
        spent, run = board.decision(course, policy), board.logs.runs[course]
        pairs = list(zip(entries, board.metrics, strict=True))
        rows.append(
            Row(
                _head(board, policy),
                (*(plus_minus(entry, m.digits) for entry, m in pairs), time_cell(spent)),
                _colour(board, policy),
                best=frozenset(i for i, found in enumerate(winners) if policy in found),
                values=(*map(in_full, entries), Number(spent.ms)),
                also=(*(in_minutes(run, m, entry) for entry, m in pairs), ""),
            )
        )
    labels, units, better = _columns(board)
    return Table(
        f"course-{course.replace('@', '-')}",
        course,
        (*labels, DECISION),
        tuple(rows),
        (),
        (*units, DECISION_UNIT),
        better=(*better, -1),
    )


def iqm_table(board: Board) -> Table:
    """Interquartile means of every score on every course, with their intervals."""
    rows = []
    for course in board.courses:
        for policy in board.players(course):
            values = np.array([board.values(course, policy, key) for key in SCORES])
            found = bootstrap(values, SEED, statistic=iqm)
            ends = zip(found.value, found.low, found.high, strict=True)
            numbers = [Number(*map(float, one)) for one in ends]
            cells = tuple(
                interval_cell(one, m.digits) for one, m in zip(numbers, board.metrics, strict=True)
            )
            head, colour = _head(board, policy), _colour(board, policy)
            rows.append(Row(head, cells, colour, group=course, values=tuple(numbers)))
    labels, units, better = _columns(board)
    note = "Mean of the middle half of the episodes, with its bootstrap 95 % interval."
    name, title = "iqm", "Interquartile means"
    return Table(name, title, labels, tuple(rows), (note,), units, stacked=True, better=better)


def interval_cell(one: Number, digits: int) -> str:
    """A number with its interval, or a dash."""
    if np.isnan(one.value):
        return NOTHING
    if np.isnan(one.low):
        return number(one.value, digits)
    return f"{number(one.value, digits)} ({number(one.low, digits)} to {number(one.high, digits)})"


def differences_table(board: Board) -> Table:
    """Every policy minus the best of its course, score by score, on the same episodes."""
    columns = {cell: _Column(board, cell) for cell in board.cells}
    rows = []
    for course in board.courses:
        found = [columns[Cell(course, key)] for key in SCORES]
        for policy in board.players(course):
            rows.append(
                Row(
                    _head(board, policy),
                    tuple(one.cell(policy) for one in found),
                    _colour(board, policy),
                    best=frozenset(i for i, one in enumerate(found) if one.apart(policy)),
                    group=course,
                    values=tuple(one.number(policy) for one in found),
                    also=tuple(one.small(policy) for one in found),
                )
            )
    labels, units, better = _columns(board)
    note = (
        "Policy minus the policy with the best mean of the course in that score, over the same "
        "episodes, with the bootstrap 95 % interval of itself alone; p: paired t-test, corrected "
        "by Holm's method for the policies of the course in that score. Bold: p below "
        f"{LEVEL:g}, {FEWEST} episodes or more. That the best was picked by these same episodes "
        "makes its lead look a little larger than it is. Bounds are not tested."
    )
    name, title = "differences", "Differences to the best of the course"
    return Table(name, title, labels, tuple(rows), (note,), units, stacked=True, better=better)


class _Column:
    """Differences to the best of a course in one score."""

    def __init__(self, board: Board, cell: Cell) -> None:
        metric, competing = describe(cell.score), board.competing(cell)
        self._p = against_best(competing, metric.better)
        self._top = best(competing, metric.better)
        self._found: dict[str, Difference] = {}
        for policy in board.players(cell.course) if self._top is not None else ():
            if policy != self._top:
                values = board.values(cell.course, policy, cell.score)
                self._found[policy] = Difference(values, competing[str(self._top)], metric)

    def cell(self, policy: str) -> str:
        if policy == self._top:
            return BEST
        return self._found[policy].cell if policy in self._found else NOTHING

    def number(self, policy: str) -> Number | None:
        if policy == self._top:
            return None
        return self._found[policy].full if policy in self._found else Number(np.nan)

    def small(self, policy: str) -> str:
        p = self._p.get(policy, np.nan)
        if np.isnan(p):
            return ""
        return f"p {p_text(p)}" if p < 0.001 else f"p = {p_text(p)}"

    def apart(self, policy: str) -> bool:
        found = self._found.get(policy)
        return found is not None and found.n >= FEWEST and self._p.get(policy, 1.0) < LEVEL


def overall_table(standing: Standing) -> Table:
    """All courses in one row per policy, the highest normalised score first, bounds last."""
    board = standing.board
    ranks = mean_ranks(board)
    winners = {cell: board.winners(cell) for cell in board.cells}
    judged = {cell for cell, found in winners.items() if found}
    shown = [key for key in SCORES if _used(standing, key)]
    rows = []
    for policy in _by_score(standing):
        place = board.policies.index(policy)
        numbers = [standing.number(standing.overall[place])]
        numbers += [standing.number(standing.scores[place, SCORES.index(key)]) for key in shown]
        played = [one for one in board.courses if policy in board.players(one)]
        own = [cell for cell in judged if cell.course in played]
        won = sum(policy in winners[cell] for cell in own)
        bound, spent = policy in board.logs.bounds, board.mean_decision(policy)
        rank = ranks.get(policy, np.nan)
        cells = [interval_cell(one, 2) for one in numbers]
        cells += [NOTHING if bound else f"{won} of {len(own)}", number(rank, 1)]
        cells += [time_cell(spent), str(len(played))]
        rest = (np.nan if bound else won, rank, spent.ms, len(played))
        values = (*numbers, *map(Number, rest))
        head, colour = _head(board, policy), _colour(board, policy)
        rows.append(Row(head, tuple(cells), colour, values=values))
    labels = [describe(key).label for key in shown]
    columns = ("all scores", *labels, "best", "rank", DECISION, "courses")
    units = ("", *("",) * len(labels), "cells", "mean", DECISION_UNIT, "")
    better = (1, *(1,) * len(labels), 1, -1, -1, 0)
    notes = (_overall_note(standing, len(judged)),)
    name, title = "overall", "All courses"
    return Table(name, title, columns, tuple(rows), notes, units, stacked=True, better=better)


def _by_score(standing: Standing) -> list[str]:
    """Policies by their normalised score, those without in the fixed order; bounds last."""
    board = standing.board
    first = dict(
        zip(board.policies, np.nan_to_num(standing.overall[:, :1].sum(axis=1)), strict=True)
    )
    return sorted(board.policies, key=lambda one: (one in board.logs.bounds, -first[one]))


def _nowhere(standing: Standing) -> str:
    """The scores that no cell of which is in the normalised ones."""
    absent = [m.label for m in standing.board.metrics if not _used(standing, m.key)]
    return f"; {joined(absent)} in none" if absent else ""


def _used(standing: Standing, key: str) -> bool:
    return any(cell.score == key for cell in standing.used)


def _overall_note(standing: Standing, judged: int) -> str:
    board = standing.board
    return (
        "Scores are normalised course by course, 0 the mean of `random` and 1 that of `oracle`, "
        "and averaged; in parentheses the bootstrap 95 % interval (episodes resampled within "
        f"courses, the same ones for all policies). Of the {len(board.cells)} cells of a course "
        f"and a score {len(standing.used)} are in it: those of the {len(board.shared)} courses "
        "that all policies play in which `oracle` is better than `random` (paired t-test at the "
        f"level {LEVEL:g}){_nowhere(standing)}. Best: cells in which the policy is best or not "
        f"told from it, of the {judged} in which some policy is told from the best. Rank: mean of "
        "the ranks by means, bounds aside. Decision: geometric mean over those courses of the CPU "
        "time that the policy takes to decide for the whole fleet, in batches, without its first "
        "call; ≤ where loading and compiling are in it."
    )
