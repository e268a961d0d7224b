"""Stored numbers are those of today's code: rows that play quickly are played again."""

import re
from pathlib import Path

import pytest

from tests.evidence.piece import Cell, load
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
    """Its policy alone plays the same episodes; the form of its intervals is that of its day."""
    piece = load(name)
    (row,) = [row for row in piece.rows if row.cells[0] == head]
    label = row.of.get("run", "")
    command = re.sub(r" --policy \S+", "", piece.runs[label]["command"])
    runs = tmp_path_factory.getbasetemp() / "played-again"
    folder: Path = play(f"{command} --policy {row.of['policy']}", runs=runs)
    again = made_row(piece, row, Runs({label: folder}))
    assert [told(cell) for cell in again.cells] == [told(cell) for cell in row.cells]


def told(cell: Cell) -> Cell:
    """Words, or means, differences and episodes of a number."""
    if not isinstance(cell, dict):
        return cell
    return {key: value for key, value in cell.items() if key in ("mean", "gap", "n")}
