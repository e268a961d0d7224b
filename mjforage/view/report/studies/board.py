"""The board: every policy on several courses, together and one by one, and who they are."""

from mjforage.runs.board import CEILING
from mjforage.view.page import style
from mjforage.view.page.table import Row, Table
from mjforage.view.report.report_page import map_words
from mjforage.view.report.studies.board_figures import frontier_picture, profiles_picture
from mjforage.view.report.studies.board_policies import policies_table
from mjforage.view.report.studies.board_scores import Board, Standing
from mjforage.view.report.studies.board_tables import (
    MARKED,
    course_table,
    differences_table,
    iqm_table,
    overall_table,
)
from mjforage.view.report.studies.study_logs import StudyLogs
from mjforage.view.report.studies.study_page import Section


def courses_table(board: Board) -> Table:
    """What each course is."""
    rows = []
    for course in board.courses:
        run = board.logs.runs[course]
        link = run.scenario.get("link", {})
        cells = (run.name, map_words(run), board.world(course), str(link.get("model", "ideal")))
        rows.append(Row(course, cells, values=(None,) * len(cells)))
    columns = ("rules", "map", "world", "link")
    return Table("courses", "Courses", columns, tuple(rows), head="course", wordy=True)


def _absent(logs: StudyLogs) -> Table | None:
    """Who does not play what, and why; None where all play all."""
    reasons: dict[tuple[str, str], list[str]] = {}
    for one in logs.info.left_out:
        reasons.setdefault((one.policy, one.reason), []).append(one.variant)
    rows = tuple(
        Row(policy, (", ".join(courses), reason), style.policy_colour(policy), values=(None, None))
        for (policy, reason), courses in reasons.items()
    )
    title = "Policies that could not play"
    return Table("left-out", title, ("courses", "reason"), rows, wordy=True) if rows else None


def _together(standing: Standing) -> list[Section]:
    words = (
        f"`{CEILING}` is shown where items are and how they drift: a bound, and not ranked. All "
        "policies of a course play the same episodes. Nobody is left out for doing badly."
    )
    drawn = [profiles_picture(standing.board), frontier_picture(standing)]
    pictures = [one for one in drawn if one is not None]
    return [
        Section("together", "All courses", words, [overall_table(standing)]),
        Section("curves", "Profiles, and what decisions cost", "", (), pictures),
    ]


def sections(logs: StudyLogs) -> list[Section]:
    """The page's sections."""
    board = Board(logs)
    standing = Standing.of(board)
    means = (
        f"Mean ± 1.96 SEM over the episodes. {MARKED} Decision: CPU time that the policy takes to "
        "decide for the whole fleet once, in the batches of episodes in which it was asked (up to "
        "50, with hulls 10), without its first call; ≤ where all chunks are a worker's first of "
        "that policy, which load and compile. Where agents know different things every one decides "
        f"for all of them. Energy: {board.metrics[-1].definition}."
    )
    absent = _absent(logs)
    who = [policies_table(board), *([absent] if absent else [])]
    return [
        *_together(standing),
        Section("courses", "Courses", "", [courses_table(board)]),
        Section(
            "scores", "Course by course", means, [course_table(board, c) for c in board.courses]
        ),
        Section(
            "differences",
            "Differences to the best of the course",
            "",
            folded=[differences_table(board)],
        ),
        Section("iqm", "Interquartile means", "", folded=[iqm_table(board)]),
        Section("policies", "What the policies are, and what they were given", "", who),
    ]
