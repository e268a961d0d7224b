"""What is no table of runs: the board's page, the checks of the physics, and speeds."""

import math
from collections.abc import Iterator
from typing import Any

from mjforage.physics.validation.finding import Measure
from mjforage.view.report.studies.board_page import write_board_page
from tests.evidence.piece import REPOSITORY, Cell, Column, Piece, Row
from tests.evidence.playing import Runs

BOARD = (
    "mjforage study board comb-port published open-bay channels comb-port-weather comb-port-radio"
    " comb-port@physics --map harbour:combs:1000 --map harbour:islands:1003 --episodes 100 --seed 7"
    " --jobs 2"
)
BOARD_PAGE = "docs/board.md"


def _board(runs: Runs) -> None:
    write_board_page(runs.folder, REPOSITORY / BOARD_PAGE)


def _speeds(runs: Runs) -> Iterator[Row]:
    for key, figure in runs.figures().items():
        quickest: Cell = {"mean": figure["quickest"]} if "quickest" in figure else None
        yield [f"`{key}`", {"mean": figure["value"]}, quickest, figure["unit"]]


def _validation(runs: Runs) -> Iterator[Row]:
    """Of each check the measure that is nearest to its limit."""
    for check in runs.figures("validation.json")["checks"]:
        worst = max(map(_measure, check["measures"]), key=lambda m: m.strain, default=None)
        head = [check["number"], f"`{check['name']}`"]
        if worst is None:
            yield [*head, None, None, None, None, check["status"]]
        else:
            value: Cell = {"mean": worst.value} if math.isfinite(worst.value) else None
            yield [*head, worst.what, value, worst.unit, worst.limit, check["status"]]


def _measure(told: dict[str, Any]) -> Measure:
    ends = {"value": math.nan, "low": -math.inf, "high": math.inf}
    numbers = {key: end if told[key] is None else told[key] for key, end in ends.items()}
    return Measure(told["what"], **numbers, unit=told["unit"])


PIECES = (
    Piece(
        "validation",
        {"": "mjforage validate"},
        (
            *(Column(""), Column("check"), Column("measured"), Column("value", 4, True)),
            *(Column("unit"), Column("limit"), Column("result")),
        ),
        _validation,
        minutes=2,
    ),
    Piece(
        "speeds",
        {"": "mjforage bench"},
        (
            *(Column("figure"), Column("value", 3, True), Column("quickest", 3, True)),
            Column("unit"),
        ),
        _speeds,
        minutes=10,
    ),
    Piece(
        "board",
        {"": BOARD},
        files=(BOARD_PAGE, "docs/board-profiles.png", "docs/board-frontier.png"),
        write=_board,
    ),
)
