"""Stored numbers are those of today's code: rows that play quickly are played again."""

import re
from pathlib import Path

import pytest

from tests.evidence.piece import load
from tests.evidence.playing import Runs, play
from tests.evidence.tables import made_row


@pytest.mark.parametrize(
    ("name", "head"),
    [
        ("comb-port", "greedy"),
        ("published", "greedy"),
        ("published-cooperation", "greedy"),
        ("comb-port-radio", "Greedy, graph, 100 episodes"),
    ],
)
def test_a_row_is_of_todays_code(
    name: str, head: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Its policy alone plays the same episodes."""
    piece = load(name)
    (row,) = [row for row in piece.rows if row.cells[0] == head]
    label = row.of.get("run", "")
    command = re.sub(r" --policy \S+", "", piece.runs[label]["command"])
    runs = tmp_path_factory.getbasetemp() / "played-again"
    folder: Path = play(f"{command} --policy {row.of['policy']}", runs=runs)
    assert made_row(piece, row, Runs({label: folder})) == row
