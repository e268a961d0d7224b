"""Two policies of each world against each other, on numbers that are known."""

from dataclasses import replace

import numpy as np

from mjforage.view.report.policy_pairs import comparison_table
from tests.mjforage.view.report.known_data import P, cells, known_run, three_worlds


def test_who_is_better_follows_the_metric_in_every_world() -> None:
    """Of NT90 the lower is better: greedy .5 beats .75 in the graph, in all pairs of episodes.

    In hulls it is .625 + or - .094 against .5 + or - .094: one of four pairs. With physics PTA_C is
    53 or 47 against 59 or 53: one tie of four pairs, .125.
    """
    assert cells(comparison_table(three_worlds())) == {
        ("greedy − levy · graph", "PTA_C [%]"): (*("*20.00*", "20.00 to 20.00", P, "1.00", "10"),),
        ("greedy − levy · graph", "NT_90"): (*("*−0.250*", "−0.250 to −0.250", P, "1.00", "10"),),
        ("greedy − levy · hulls", "PTA_C [%]"): (*("*10.00*", "10.00 to 10.00", P, "1.00", "10"),),
        ("greedy − levy · hulls", "NT_90"): (*("*0.125*", "0.125 to 0.125", P, "0.25", "10"),),
        ("greedy − levy · physics", "PTA_C [%]"): (
            *("*−6.00*", "−6.00 to −6.00", P, "0.12", "10"),
        ),
        ("greedy − levy · physics", "NT_90"): (*("*0.125*", "0.125 to 0.125", P, "0.25", "10"),),
    }


def test_episodes_that_one_of_two_lacks_are_no_pairs() -> None:
    """Differences 1, -1, 4 and five of -1: mean -1/8. Of 9 x 9 episodes 29.5 are won, .364.

    2 beats one and ties with five, 4 beats six and ties with one, 6 beats eight, 8 all, and each of
    the five 1 ties with one: 3.5 + 6.5 + 8 + 9 + 2.5.
    """
    nan = float("nan")
    some = [2.0, 4.0, nan, 6.0, 8.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    other = [1.0, nan, 5.0, 7.0, 4.0, 2.0, 2.0, 2.0, 2.0, 2.0]
    means = {("graph", "greedy"): {"csr": some}, ("graph", "levy"): {"csr": other}}
    table = comparison_table(known_run(means))
    (row,) = table.rows
    assert row.values[0] is not None and row.values[0].value == -0.125
    assert (row.cells[3:], row.best) == (("0.36", "8"), frozenset())


def test_bounds_are_named_and_metrics_without_a_direction_have_no_winner() -> None:
    means = {("graph", "greedy"): {"oddness": 3.0}, ("graph", "oracle"): {"oddness": 1.0}}
    table = comparison_table(known_run(means, bounds=("oracle",)))
    ((place, row),) = cells(table).items()
    assert place == ("greedy − oracle (bound)", "oddness")
    assert (row[0], row[3]) == ("*2.0000*", "–")


def test_which_pairs_differ_is_told_pair_by_pair() -> None:
    """PTA_C is alike on average in the graph, and differs in hulls."""
    turn = [1.0, -1.0] * 5
    means = {
        ("graph", "greedy"): {"pta_c": [50.0 + one for one in turn]},
        ("graph", "levy"): {"pta_c": [50.0] * 10},
        ("hulls", "greedy"): {"pta_c": [60.0 + one for one in turn]},
        ("hulls", "levy"): {"pta_c": [50.0] * 10},
    }
    table = comparison_table(known_run(means))
    assert [(row.group, set(row.best)) for row in table.rows] == [
        ("greedy − levy · graph", set()),
        ("greedy − levy · hulls", {0}),
    ]


def test_episodes_are_paired_by_their_number_not_by_their_row() -> None:
    """Rows of a file come in any order. Episode by episode greedy has one more."""
    means = {
        ("graph", "greedy"): {"pta_c": [float(n) + 1 for n in range(10)]},
        ("graph", "levy"): {"pta_c": [float(n) for n in range(10)]},
    }
    logs = known_run(means)
    of_levy = logs.episodes["policy"].to_numpy() == "levy"
    shuffled = [*np.flatnonzero(~of_levy), *np.flatnonzero(of_levy)[::-1]]
    table = comparison_table(replace(logs, episodes=logs.episodes[[int(n) for n in shuffled]]))
    assert [row[:2] for row in cells(table).values()] == [("*1.00*", "1.00 to 1.00")]
