"""Stored numbers are those of today's code: rows that play quickly are played again."""

from pathlib import Path

from tests.evidence import data, playing
from tests.evidence.piece import Row, average, mean
from tests.evidence.pieces import PIECES
from tests.evidence.pieces.results import COOPERATION, PRIMARY, means


def of(name: str, first: str) -> Row:
    """A stored row by its first cell."""
    (row,) = [row for row in data.load(PIECES[name])["rows"] if row[0] == first]
    return list(row)


def alone(name: str, policy: str, tmp_path: Path, label: str = "") -> playing.Runs:
    """A command of a piece, with one of its policies alone: it plays the same episodes."""
    words = PIECES[name].runs[label].split()
    for flag in ("--policy", "--jobs"):
        while flag in words:
            del words[words.index(flag) : words.index(flag) + 2]
    command = " ".join([*words, "--policy", policy])
    return playing.Runs({"": playing.play(command, runs=tmp_path)})


def test_the_tables_of_results_are_of_todays_code(tmp_path: Path) -> None:
    played = alone("comb-port", "greedy", tmp_path)
    assert next(means(("greedy",), PRIMARY)(played)) == of("comb-port", "greedy")
    played = alone("published", "greedy", tmp_path)
    assert next(means(("greedy",), PRIMARY)(played)) == of("published", "greedy")
    assert next(means(("greedy",), COOPERATION)(played)) == of("published-cooperation", "greedy")


def test_radios_and_eyes_are_of_todays_code(tmp_path: Path) -> None:
    run = alone("comb-port-radio", "greedy", tmp_path, "graph").only
    keys = ("pta_c", "nt50", "nt90", "handover")
    stored = of("comb-port-radio", "Greedy, graph, 100 episodes")
    assert [mean(run.values("greedy", key)) for key in keys] == stored[1:]
    run = alone("eyes", "greedy", tmp_path, "*p* .5").only
    stored = of("eyes", "*p* .5")
    for cell, key in zip(stored[1:3], ("pta_c", "nt90"), strict=True):
        found = average(run.values("greedy", key))
        assert isinstance(cell, dict) and isinstance(found, dict)
        assert (found["mean"], found["n"]) == (cell["mean"], cell["n"])
