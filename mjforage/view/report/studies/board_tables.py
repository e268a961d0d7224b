"""Tables of the board: each task, its middle half, differences to the best, and all together."""

from collections.abc import Sequence

import numpy as np

from mjforage.metrics import FEWEST
from mjforage.mission.scoring import describe
from mjforage.view.page.figure import joined
from mjforage.view.page.table import NOTHING, Number, Row, Table
from mjforage.view.report.best_marks import best_first
from mjforage.view.report.cells import (
    TOLD,
    UNDEFINED,
    Cell,
    interval_cell,
    metrics_table,
    number,
    number_cell,
    row,
    summary_cell,
)
from mjforage.view.report.differences import HOW, LEVEL, estimates, p_text, pairs
from mjforage.view.report.studies.board_scores import (
    SCORES,
    Board,
    Decision,
    Standing,
    TaskScore,
    mean_ranks,
)

DECISION = "Decision"
DECISION_UNIT = "ms of CPU"
BEST = "best"
MARKED = (
    "Bold: the best mean of the column and those that cannot be told from it (multiple comparisons "
    f"with the best: {HOW} of all pairs over the same episodes, together at the level {LEVEL:g}, "
    f"{FEWEST} episodes or more; bounds aside)."
)


def time_cell(spent: Decision) -> Cell:
    """Three digits of a time of any size; an upper bound where loading is in it."""
    if np.isnan(spent.ms):
        return UNDEFINED
    digits = max(0, 2 - int(np.floor(np.log10(spent.ms)))) if spent.ms > 0 else 0
    return Cell(f"{'≤ ' if spent.at_most else ''}{number(spent.ms, digits)}", Number(spent.ms))


def _policy_row(board: Board, policy: str, cells: Sequence[Cell], group: str = "") -> Row:
    return row(board.head(policy), cells, board.colour(policy), group=group)


def task_table(board: Board, task: str) -> Table:
    """Means of every score on a task, and the time of a decision."""
    rows = []
    for policy in board.players(task):
        case = board.case(task, policy)
        cells = [
            summary_cell(case, metric, policy in board.winners[task, metric.key])
            for metric in board.metrics
        ]
        rows.append(_policy_row(board, policy, [*cells, time_cell(board.decision(task, policy))]))
    name, found = f"task-{task.replace('@', '-')}", board.metrics
    return Table(
        name,
        task,
        (*(metric.label for metric in found), DECISION),
        tuple(rows),
        units=(*(metric.unit for metric in found), DECISION_UNIT),
        better=(*(metric.better for metric in found), -1),
    )


def differences_table(board: Board) -> Table:
    """Every policy minus the best of its task, score by score, on the same episodes."""
    columns = {cell: _column(board, cell) for cell in board.cells}
    rows = [
        _policy_row(board, policy, [columns[task, key][policy] for key in SCORES], task)
        for task in board.tasks
        for policy in board.players(task)
    ]
    note = (
        "Policy minus the policy with the best mean of the task in that score, over the same "
        "episodes, with its 95 % interval and p, which hold for all pairs of policies of the task "
        f"in that score together ({HOW}). Bold: p below {LEVEL:g}. Those of a bound are of itself "
        "alone."
    )
    title = "Differences to the best of the task"
    return metrics_table("differences", title, board.metrics, rows, [note], stacked=True)


def _column(board: Board, cell: TaskScore) -> dict[str, Cell]:
    """Policies of a task -> difference to its best in one score."""
    (task, score), competing = cell, board.competing(cell)
    metric = describe(score)
    names = best_first(competing, metric.better)
    if not names:
        return dict.fromkeys(board.players(task), UNDEFINED)
    top = names[0]
    found = {top: Cell(BEST)}
    tested = pairs(competing, metric.digits)
    for policy in board.players(task):
        if policy != top:
            gaps = board.case(task, policy).values(score) - competing[top]
            gap = tested.get((policy, top)) or estimates([(gaps, metric.digits)])[0]
            p = gap.p
            small = "" if np.isnan(p) else f"p {p_text(p)}" if p < 0.001 else f"p = {p_text(p)}"
            found[policy] = gap.cell(small)
    return found


def overall_table(standing: Standing) -> Table:
    """All tasks in one row per policy, the highest normalised score first, bounds last."""
    board, ranks = standing.board, mean_ranks(standing.board)
    judged = [cell for cell, found in board.winners.items() if board.told(cell)]
    shown = standing.normalised
    rows = []
    for policy in _by_score(standing):
        place = board.policies.index(policy)
        means = [standing.overall[place]]
        means += [standing.scores[place, SCORES.index(key)] for key in shown]
        played = [task for task in board.tasks if policy in board.players(task)]
        own = [cell for cell in judged if cell[0] in played]
        won = sum(policy in board.winners[cell] for cell in own)
        bound = policy in board.logs.bounds
        cells = [
            Cell(board.logs.told.get(policy, NOTHING)),
            *(interval_cell(standing.number(mean), 2) for mean in means),
            UNDEFINED if bound else Cell(f"{won} of {len(own)}", Number(won)),
            number_cell(ranks.get(policy, np.nan), 1),
            time_cell(board.mean_decision(policy)),
            number_cell(len(played), 0),
        ]
        rows.append(_policy_row(board, policy, cells))
    labels = [describe(key).label for key in shown]
    columns = (TOLD, "all scores", *labels, "best", "rank", DECISION, "tasks")
    units = ("", "", *("",) * len(labels), "cells", "mean", DECISION_UNIT, "")
    better = (0, 1, *(1,) * len(labels), 1, -1, -1, 0)
    notes = (_overall_note(standing, len(judged)),)
    name, title = "overall", "All tasks"
    return Table(name, title, columns, tuple(rows), notes, units, stacked=True, better=better)


def _by_score(standing: Standing) -> list[str]:
    """Policies by their normalised score, those without in the fixed order; bounds last."""
    board = standing.board
    scores = np.nan_to_num(standing.overall[:, :1].sum(axis=1))
    first = dict(zip(board.policies, scores, strict=True))
    return sorted(board.policies, key=lambda one: (one in board.logs.bounds, -first[one]))


def _overall_note(standing: Standing, judged: int) -> str:
    board = standing.board
    absent = [metric.label for metric in board.metrics if metric.key not in standing.normalised]
    nowhere = f"; {joined(absent)} in none" if absent else ""
    return (
        "Scores are normalised task by task, 0 the mean of `random` and 1 that of `oracle`, "
        "and averaged; in parentheses the bootstrap 95 % interval (episodes resampled within "
        f"tasks, the same ones for all policies). Of the {len(board.cells)} cells of a task "
        f"and a score {len(standing.used)} are in it: those of the {len(board.shared)} tasks "
        "that all policies play in which `oracle` is better than `random` (paired, at the level "
        f"{LEVEL:g}){nowhere}. Best: cells in which the policy is best or not "
        f"told from it, of the {judged} in which some policy is told from the best. Rank: mean of "
        "the ranks by means, bounds aside. Decision: geometric mean over those tasks of the CPU "
        "time that the policy takes to decide for the whole fleet, in batches, without its first "
        "call; ≤ where loading and compiling are in it."
    )
