"""Tables and figures of the board, on numbers chosen by hand."""

from dataclasses import replace

import numpy as np
import pytest

from mjforage.metrics import compared
from mjforage.runs.costs import Cost
from mjforage.scenario.scenario_file import load_scenario, scenario_to_tree
from mjforage.view.page.style import policy_colour
from mjforage.view.page.table import NOTHING, Row, Table
from mjforage.view.report.studies import board as page
from mjforage.view.report.studies.board_figures import frontier_picture, profiles_picture
from mjforage.view.report.studies.board_page import command_of
from mjforage.view.report.studies.board_scores import (
    SCORES,
    Board,
    Decision,
    Standing,
    mean_ranks,
)
from mjforage.view.report.studies.board_tables import (
    differences_table,
    overall_table,
    task_table,
)
from mjforage.view.report.studies.study_logs import StudyLogs
from tests.mjforage.view.report.made_up_study import made_up_study, with_values

PLAYERS = ("greedy", "levy", "random", "oracle")
EPISODES = 12
NOISE = np.random.default_rng(5).normal(0.0, 1.0, EPISODES)
NOISE -= NOISE.mean()
PTA = {
    "bay": {"random": 20.0, "oracle": 100.0, "greedy": 60.0, "levy": 40.0},
    "port": {"random": 0.0, "oracle": 50.0, "greedy": 40.0, "levy": 5.0},
}
NT90 = {"random": 1.0, "oracle": 0.2, "greedy": 0.6, "levy": 0.6}


def cost(course: str, policy: str, began: float, decide_s: float, worker: str = "w") -> Cost:
    about = ("graph", policy, 6, 60, 9.0, 9.0, began, worker, "call", "processes", 1)
    return Cost(*about, decide_s=decide_s, decisions=1000)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> StudyLogs:
    """Make a study of two courses; levy does not play a third."""
    courses = {"bay": PLAYERS, "port": PLAYERS, "far": ("greedy", "random", "oracle")}
    left = {"policy": "levy", "variant": "far", "reason": "policy levy: no legs"}
    folder = tmp_path_factory.mktemp("made") / "study"
    logs = made_up_study(folder, courses, EPISODES, "board", left_out=[left])
    values = {
        (course, policy, "pta_c"): mean + 0.01 * (place + 1) * np.roll(NOISE, place)
        for course, found in PTA.items()
        for place, (policy, mean) in enumerate(found.items())
    }
    for course in PTA:
        for policy, mean in NT90.items():
            values[course, policy, "nt90"] = mean + 0.0 * NOISE
        for policy in PLAYERS:  # nothing is told in any other score
            for score in set(SCORES) - {"pta_c", "nt90"}:
                values[course, policy, score] = 0.5 + 0.0 * NOISE
    return with_values(logs, values)


@pytest.fixture
def board(made: StudyLogs) -> Board:
    return Board(made)


def row(table: Table, head: str, group: str = "") -> Row:
    (found,) = [one for one in table.rows if (one.head, one.group) == (head, group)]
    return found


def test_scores_are_0_at_random_and_1_at_the_oracle_course_by_course(board: Board) -> None:
    """Greedy: (60 - 20) / 80 = .5 and 40 / 50 = .8; NT90 (.6 - 1) / (.2 - 1) = .5 in both."""
    found = Standing.of(board)
    assert set(found.used) == {(course, score) for course in PTA for score in ("pta_c", "nt90")}
    greedy, levy = (found.scores[board.policies.index(name)] for name in ("greedy", "levy"))
    pta, nt = SCORES.index("pta_c"), SCORES.index("nt90")
    assert found.number(greedy[pta]).value == pytest.approx((0.5 + 0.8) / 2)
    assert found.number(levy[pta]).value == pytest.approx((0.25 + 0.1) / 2)
    assert found.number(greedy[nt]).value == pytest.approx(0.5)
    overall = dict(zip(board.policies, found.overall[:, 0], strict=True))
    assert overall["greedy"] == pytest.approx((0.5 + 0.8 + 0.5 + 0.5) / 4)
    assert (overall["random"], overall["oracle"]) == pytest.approx((0.0, 1.0))
    assert np.isnan(greedy[SCORES.index("csr")]).all(), "nobody is told from random in it"
    number = found.number(found.overall[board.policies.index("greedy")])
    assert number.low < number.value < number.high
    assert number.high - number.low < 0.001


def test_a_score_in_which_the_oracle_is_no_better_than_random_is_not_normalised(
    made: StudyLogs,
) -> None:
    wrong = {("bay", "oracle", "nt90"): 1.5 + 0.01 * NOISE}
    used = Standing.of(Board(with_values(made, wrong))).used
    assert ("bay", "nt90") not in used
    assert ("port", "nt90") in used
    noisy = {("port", "oracle", "pta_c"): 1.0 + 10.0 * NOISE}  # better by chance
    assert ("port", "pta_c") not in Standing.of(Board(with_values(made, noisy))).used


def test_ranks_are_means_over_cells_and_equals_share_theirs(made: StudyLogs) -> None:
    """PTA_C: greedy 1, levy 2, random 3. NT90: 1.5, 1.5, 3. All alike in the other four: 2."""
    logs = replace(made, runs={name: made.runs[name] for name in PTA})
    found = mean_ranks(Board(logs))
    assert found == pytest.approx(
        {"greedy": (1 + 1.5 + 8) / 6, "levy": (2 + 1.5 + 8) / 6, "random": (3 + 3 + 8) / 6}
    )


def test_the_best_and_those_not_told_from_it_are_marked_bounds_aside(board: Board) -> None:
    assert board.winners["bay", "pta_c"] == {"greedy"}
    assert board.winners["bay", "nt90"] == {"greedy", "levy"}
    assert board.winners["bay", "csr"] == {"greedy", "levy", "random"}, "all are alike"
    assert not board.told(("bay", "csr"))
    table = task_table(board, "bay")
    assert row(table, "greedy").best == {0, 1, 2, 3, 4, 5}
    assert row(table, "levy").best == {1, 2, 3, 4, 5}
    assert row(table, "oracle (bound)").best == frozenset()
    assert (table.columns[-1], table.better[-1]) == ("Decision", -1)
    assert row(table, "greedy").cells[0].startswith("60.00 (")


def test_differences_to_the_best_hold_for_all_pairs_together(made: StudyLogs) -> None:
    values = {
        ("bay", "greedy", "pta_c"): 60 + 0.0 * NOISE,
        ("bay", "levy", "pta_c"): 57.9 + 1.7 * np.roll(NOISE, 1),
        ("bay", "random", "pta_c"): 59.7 + 2.0 * np.roll(NOISE, 2),
    }
    board = Board(with_values(made, values))
    greedy, levy, by_chance = values.values()
    family = compared([levy - greedy, by_chance - greedy, levy - by_chance])
    table = differences_table(board)
    for place, who in enumerate(("levy", "random")):
        found = row(table, who, "bay")
        assert found.also[0] == f"p = {family.p[place]:.3f}"
        assert (0 in found.best) == (family.p[place] < 0.05) == (who == "levy")
        assert found.values[0] == pytest.approx([part[place] for part in family[:3]])
    assert board.winners["bay", "pta_c"] == {"greedy", "random"}
    assert row(table, "greedy", "bay").cells[0] == "best"
    assert row(table, "levy", "bay").cells[0].startswith("−2.1")
    assert not [one for one in table.rows if (one.head, one.group) == ("levy", "far")]


def test_differences_are_to_the_lowest_where_less_is_better(made: StudyLogs) -> None:
    """Of NT90: levy .5 is best, greedy .125 and random .5 later; the oracle is a bound."""
    values = {("bay", "levy", "nt90"): 0.5 + 0.0 * NOISE}
    values |= {("bay", "greedy", "nt90"): 0.625 + 0.0 * NOISE}
    table = differences_table(Board(with_values(made, values)))
    place = table.columns.index("NT_90")
    assert table.better[place] == -1
    assert row(table, "levy", "bay").cells[place] == "best"
    assert row(table, "greedy", "bay").cells[place] == "0.125 (0.125 to 0.125)"
    assert row(table, "random", "bay").cells[place] == "0.500 (0.500 to 0.500)"
    assert place in row(table, "greedy", "bay").best


def test_the_time_of_decisions_is_of_warm_chunks_if_there_are_any(made: StudyLogs) -> None:
    """Bay: the worker's first chunk, 8 s, is left out for 2 and 4 s of 1,000 decisions each."""
    costs = {
        "bay": tuple(cost("bay", "greedy", *one) for one in ((0.0, 8.0), (1.0, 2.0), (2.0, 4.0))),
        "port": (cost("port", "greedy", 3.0, 12.0), cost("port", "levy", 4.0, 5.0)),
        "far": (),
    }
    board = Board(replace(made, costs=costs))
    assert board.decision("bay", "greedy") == Decision(3.0)
    assert board.decision("port", "greedy") == Decision(12.0)
    assert board.decision("port", "levy") == Decision(5.0, at_most=True)
    assert np.isnan(board.decision("bay", "levy").ms)
    mean = board.mean_decision("greedy")
    assert mean.ms == pytest.approx(6.0), "geometric"
    assert not mean.at_most
    assert np.isnan(board.mean_decision("levy").ms), "not measured on the bay"


def test_the_table_of_all_courses_has_the_best_first_and_bounds_last(board: Board) -> None:
    table = overall_table(Standing.of(board))
    assert [one.head for one in table.rows] == ["greedy", "levy", "random", "oracle (bound)"]
    scored = ("all scores", "PTA_C", "NT_90")
    assert table.columns[:4] == ("told of items", *scored), "no column without a score"
    assert table.better == (0, 1, 1, 1, 1, -1, -1, 0), "normalised, NT90 too is better upwards"
    place = table.columns.index("best")
    won = {one.head: one.cells[place] for one in table.rows}
    judged = sum(board.told(cell) for cell in board.cells)
    here = sum(board.told(cell) for cell in board.cells if cell[0] in PTA)
    assert here == 4
    assert won["levy"] == "2 of 4", "of the cells that it played: NT90 twice"
    assert won["greedy"].endswith(f" of {judged}")
    assert won["oracle (bound)"] == NOTHING
    assert row(table, "levy").cells[-1] == "2"
    assert "CSR and Energy in none" in table.notes[0]


def test_profiles_are_shares_of_the_runs_of_all_shared_courses(board: Board) -> None:
    """PTA_C of greedy is some 60 on the bay and some 40 in the port: half of its runs reach 50."""
    drawn = profiles_picture(board)
    assert drawn is not None
    assert "oracle (bound)" in [text.get_text() for text in drawn.figure.legends[0].get_texts()]
    first = drawn.figure.axes[0]
    lines = {str(line.get_color()): line for line in first.lines}
    tau, share = np.asarray(lines[policy_colour("greedy")].get_xydata()).T
    assert share[np.argmin(abs(tau - 50))] == 0.5
    assert share[np.argmin(abs(tau - 30))] == 1.0
    assert share[-1] == 0.0
    fourth = drawn.figure.axes[3]
    assert fourth.get_xlabel() == "NT$_{\\mathrm{90}}$ ≤ τ"
    lines = {str(line.get_color()): line for line in fourth.lines}
    tau, share = np.asarray(lines[policy_colour("greedy")].get_xydata()).T
    assert share[np.argmin(abs(tau - 0.5))] == 0.0, "its .6 is at most .7, not at most .5"
    assert share[np.argmin(abs(tau - 0.7))] == 1.0


def test_the_frontier_names_who_is_on_it_and_where_less_is_better_it_is_turned(
    made: StudyLogs,
) -> None:
    """Levy is the cheapest, greedy better for more; random is dearer and worse than both."""
    spent = {"levy": 1.0, "greedy": 2.0, "random": 3.0, "oracle": 0.5}
    costs = {
        course: tuple(cost(course, who, 1.0, s) for who, s in spent.items())
        for course in made.costs
    }
    drawn = frontier_picture(Standing.of(Board(replace(made, costs=costs))))
    assert drawn is not None
    assert (
        "normalised score: levy and greedy; PTA_C: levy and greedy; NT_90: levy." in drawn.caption
    )
    score, _, nt90 = drawn.figure.axes
    assert nt90.yaxis_inverted() and not score.yaxis_inverted()
    assert score.get_xscale() == "log"
    assert frontier_picture(Standing.of(Board(made))) is None, "no time was measured"


def test_the_page_says_who_could_not_play_and_why(made: StudyLogs) -> None:
    tables = {table.name: table for section in page.sections(made) for table in section.numbers}
    (levy,) = tables["left-out"].rows
    assert (levy.head, levy.cells) == ("levy", ("far", "policy levy: no legs"))
    assert [one.head for one in tables["tasks"].rows] == ["bay", "port", "far"]
    assert {"overall", "task-far", "differences"} <= set(tables)


def test_the_command_on_the_page_names_no_folder(made: StudyLogs) -> None:
    told = "mjforage study board --out /somewhere/else comb-port --policy 'greedy(distance=2)'"
    logs = replace(made, info=replace(made.info, command=told))
    assert command_of(logs) == "mjforage study board comb-port --policy 'greedy(distance=2)'"
    glued = replace(made, info=replace(made.info, command="mjforage study board --out=/x a"))
    assert command_of(glued) == "mjforage study board a"
    called = replace(made, info=replace(made.info, command="made in Python (mjforage.board)"))
    assert command_of(called) == "# made in Python (mjforage.board)"


def test_policies_stand_beside_what_they_are_told(board: Board) -> None:
    table = overall_table(Standing.of(board))
    at = table.columns.index("told of items")
    told = {one.head: one.cells[at] for one in table.rows}
    assert told["greedy"] == NOTHING
    assert told["oracle (bound)"] == "the items"


@pytest.mark.parametrize(
    ("preset", "same"),
    [("comb-port", True), ("published", True), ("comb-port-few", False)],
)
def test_items_of_another_law_are_noticed(preset: str, same: bool) -> None:
    assert page.as_told(scenario_to_tree(load_scenario(preset))) is same
    three = scenario_to_tree(load_scenario(preset, ["prior.hotspots=3"]))
    assert not page.as_told(three)
