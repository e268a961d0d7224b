"""Tables of a run whose numbers are known: means, marks of the best, arrows."""

from dataclasses import replace

import numpy as np
import pytest

from mjforage.view.page.table import NOTHING
from mjforage.view.report.best_marks import best_and_alike, best_first
from mjforage.view.report.cells import TOLD
from mjforage.view.report.shown import shown_policies
from mjforage.view.report.text_tables import full_table, headline_table, metric_table
from tests.mjforage.view.report.known_data import (
    Means,
    cells,
    known_run,
    starred,
    three_worlds,
    told,
)

KEYS = ("pta_c", "nt90")


def test_the_best_of_each_world_is_marked_by_the_way_of_its_metric() -> None:
    """Levy has the lower NT90 in hulls and with physics, and there the higher PTA_C too."""
    table = metric_table(three_worlds(), "t", "T", KEYS, paper=False)
    assert cells(table) == {
        ("", "greedy · graph"): (f"*{told('pta_c', 80.0)}*", f"*{told('nt90', 0.500)}*"),
        ("", "greedy · hulls"): (f"*{told('pta_c', 60.0)}*", told("nt90", 0.625)),
        ("", "greedy · physics"): (told("pta_c", 50.0), told("nt90", 1.000)),
        ("", "levy · graph"): (told("pta_c", 60.0), told("nt90", 0.750)),
        ("", "levy · hulls"): (told("pta_c", 50.0), f"*{told('nt90', 0.500)}*"),
        ("", "levy · physics"): (f"*{told('pta_c', 56.0)}*", f"*{told('nt90', 0.875)}*"),
    }
    assert (table.columns, table.better) == (("PTA_C", "NT_90"), (1, -1))
    minutes = [row.also[1] for row in table.rows]
    assert minutes == ["12.5 min", "15.6 min", "25.0 min", "18.8 min", "12.5 min", "21.9 min"]
    assert table.rows[0].values[0] == pytest.approx((80.0, 68.86, 83.54), abs=0.01)


def test_steps_are_told_in_minutes_by_their_period() -> None:
    """30 steps of 10 s."""
    logs = known_run({("graph", "greedy"): {"length": 30.0}})
    (row,) = metric_table(logs, "t", "T", ("length",), paper=False).rows
    assert (row.cells, row.also) == ((told("length", 30.0),), ("5.0 min",))


def test_a_bound_is_not_best_and_not_in_the_way_of_it() -> None:
    means: Means = {
        ("graph", "oracle"): {"pta_c": 99.0, "nt90": 0.125},
        ("graph", "greedy"): {"pta_c": 80.0, "nt90": 0.5},
        ("graph", "levy"): {"pta_c": 60.0, "nt90": 0.25},
    }
    table = metric_table(known_run(means, bounds=("oracle",)), "t", "T", KEYS, paper=False)
    assert {row.head: set(row.best) for row in table.rows} == {
        "greedy": {0},
        "levy": {1},
        "oracle (bound)": set(),
    }


def test_what_policies_are_told_is_a_column_where_any_is_told_something() -> None:
    logs = known_run({("graph", "greedy"): {"pta_c": 50.0}, ("graph", "belief"): {"pta_c": 60.0}})
    plain = metric_table(logs, "t", "T", ("pta_c",))
    assert TOLD not in plain.columns
    knowing = replace(logs, run=replace(logs.run, told={"belief": "their law"}))
    table = metric_table(knowing, "t", "T", ("pta_c",))
    assert (table.columns[0], len(table.units), len(table.better)) == (TOLD, 2, 2)
    words = {row.head: row.cells[0] for row in table.rows if not row.paper}
    assert words == {"greedy": NOTHING, "belief": "their law"}
    assert {row.cells[0] for row in table.rows if row.paper} == {NOTHING}
    for row, before in zip(table.rows, plain.rows, strict=True):
        assert row.cells[1:] == before.cells and row.values[1:] == before.values
        assert row.best == {place + 1 for place in before.best}


def test_the_papers_numbers_stand_below_the_last_world_of_their_policy() -> None:
    """Greedy of its Tables 2 and 3, then of its public code: ± where it tells one."""
    rows = metric_table(three_worlds(), "t", "T", KEYS).rows
    assert [row.head for row in rows if not row.paper][2] == rows[2].head == "greedy · physics"
    assert [(row.head, row.cells) for row in rows[3:5]] == [
        ("Greedy, paper (its own map)", ("98.20 ± 1.15", "0.583")),
        ("Greedy, its public code (its own map), 1,300 episodes", ("97.20 ± 0.51", "0.591")),
    ]
    assert rows[3].values[0] == pytest.approx((98.2, 97.05, 99.35))


def test_who_is_not_told_from_the_best_is_marked_with_it() -> None:
    """Of 10 episodes c is below a in all; b is .1 below with an SEM of 1/3: t = .3."""
    turn = np.resize([1.0, -1.0], 10)
    values = {"a": np.full(10, 5.0), "b": 4.9 + turn, "c": np.full(10, 3.0)}
    assert best_first(values, 1) == ["a", "b", "c"] and best_first(values, -1) == ["c", "b", "a"]
    assert best_and_alike(values, 1) == {"a", "b"}
    assert best_and_alike(values, -1) == {"c"}
    nine = {name: found[:9] for name, found in values.items()}
    assert best_and_alike(nine, 1) == set(), "too few episodes"
    assert best_and_alike({"a": values["a"], "b": values["b"]}, 1) == {"a", "b"}, "all alike"
    assert best_and_alike({"a": values["a"]}, 1) == set(), "nothing to be better than"


def test_equals_are_all_marked_in_95_of_100_tables() -> None:
    """40 tables of 9 equal policies, 30 episodes each: 1 % of binomial(40, .05) lies above 6."""
    random = np.random.default_rng(2)
    tables = (dict(enumerate(random.gamma(1.0, size=(9, 30)))) for _ in range(40))
    assert sum(len(best_and_alike(one, 1)) < 9 for one in tables) <= 6


def test_the_table_of_all_metrics_has_each_with_its_spread() -> None:
    """Episodes of one policy: 0 eight times, 4 and 8: mean 1.2, the middle half 0."""
    episodes = [0.0] * 8 + [4.0, 8.0]
    logs = known_run({("graph", "greedy"): {"pta_c": episodes, "nt90": 0.5}})
    table = full_table(logs)
    assert table.columns == ("mean", "95 % interval", "IQM", "worst 5 %", "n")
    (row,) = [one for one in table.rows if one.group == "PTA_C [%]"]
    assert row.cells == ("1.20", "0.00 to 14.81 rough", "0.00", "0.00", "10")
    assert row.group_better == 1
    (row,) = [one for one in table.rows if one.group == "NT_90"]
    assert (starred(row)[0], row.group_better) == ("0.500", -1)


def test_the_table_in_brief_tells_the_horizon_in_minutes() -> None:
    """150 steps of 10 s."""
    assert "shares of the horizon, 25 min" in headline_table(three_worlds()).notes[0]


def test_of_very_many_policies_the_best_are_shown() -> None:
    """Of 24 with PTA_C of 1 to 24 the best 20, in the order of their names."""
    means = {("graph", f"p{n:02}"): {"pta_c": float(n)} for n in range(1, 25)}
    shown = shown_policies(known_run(means))
    assert shown == tuple(f"p{n:02}" for n in range(5, 25))
