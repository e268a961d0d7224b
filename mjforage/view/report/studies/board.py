"""The leaderboard: every policy on several tasks, together and one by one, with descriptions."""

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from mjforage.runs.studies.board import CEILING
from mjforage.scenario.prior import Prior
from mjforage.scenario.scenario import Items
from mjforage.view.page import style
from mjforage.view.page.table import Row, Table
from mjforage.view.report.cells import INTERVAL
from mjforage.view.report.report_page import map_words
from mjforage.view.report.sections import Section
from mjforage.view.report.studies.board_figures import frontier_picture, profiles_picture
from mjforage.view.report.studies.board_scores import Board, Standing
from mjforage.view.report.studies.board_tables import (
    MARKED,
    differences_table,
    overall_table,
    task_table,
)
from mjforage.view.report.studies.study_logs import StudyLogs


def tasks_table(board: Board) -> Table:
    """Rules, map, world and link of each task, and whether its items have the law told."""
    rows = []
    for task, logs in board.logs.runs.items():
        run = logs.run
        link = run.scenario.get("link", {}).get("model", "ideal")
        items = "as told" if as_told(run.scenario) else "**not as told**"
        rows.append(Row(task, (run.name, map_words(run), run.worlds[0], str(link), items)))
    columns = ("rules", "map", "world", "link", "items")
    return Table("tasks", "Tasks", columns, tuple(rows), head="task", wordy=True)


def as_told(scenario: Mapping[str, Any]) -> bool:
    """True if a scenario's items have the number, clusters and spread that its planners assume."""
    items, prior = asdict(Items()) | scenario["items"], asdict(Prior()) | scenario.get("prior", {})
    drawn = items["hotspots"], items["mean"], items["std"], math.sqrt(items["covariance_node2"])
    assumed = (prior[key] for key in ("hotspots", "items", "items_sd", "spread_node"))
    return all(math.isclose(a, b, rel_tol=0.01) for a, b in zip(drawn, assumed, strict=True))


def _absent(logs: StudyLogs) -> Table:
    """Policies that do not play a task, and why."""
    reasons: dict[tuple[str, str], list[str]] = {}
    for one in logs.info.left_out:
        reasons.setdefault((one.policy, one.reason), []).append(one.variant)
    rows = tuple(
        Row(policy, (", ".join(tasks), reason), style.policy_colour(policy))
        for (policy, reason), tasks in reasons.items()
    )
    title = "Policies that could not play"
    return Table("left-out", title, ("tasks", "reason"), rows, wordy=True)


def sections(logs: StudyLogs) -> list[Section]:
    """The page's sections."""
    board = Board(logs)
    standing = Standing.of(board)
    together = (
        f"`{CEILING}` receives the true items and their drift: an upper bound, and not ranked. All "
        "policies of a task play the same episodes. No policy is left out for doing badly. *Told "
        "of items*: their law is what `[prior]` says, 75 ± 10 items in one cluster, its spread and "
        "the range of the drift, as most scenarios draw them."
    )
    means = (
        f"{INTERVAL}. {MARKED} Decision: CPU time that the policy takes to "
        "decide for the whole fleet once, in the batches of episodes in which it was asked (up to "
        "50, with hulls 10), without its first call; ≤ where all chunks are a worker's first of "
        "that policy, which load and compile. Where agents have different information every one "
        f"decides for all of them. Energy: {board.metrics[-1].definition}."
    )
    drawn = [one for one in (profiles_picture(board), frontier_picture(standing)) if one]
    least = "Differences to the best of the task"
    return [
        Section("together", "All tasks", together, [overall_table(standing)]),
        Section("curves", "Profiles, and the cost of decisions", pictures=drawn),
        Section("tasks", "Tasks", tables=[tasks_table(board)]),
        Section("scores", "Task by task", means, [task_table(board, one) for one in board.tasks]),
        Section("differences", least, folded=[differences_table(board)]),
        Section("left-out", "Policies that could not play", tables=[_absent(logs)]),
    ]
