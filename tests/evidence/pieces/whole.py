"""What is no table of runs: the board's page, the checks of the physics, and speeds."""

from collections.abc import Iterator

from mjforage.view.report.studies.board_page import write_board_page
from tests.evidence.piece import REPOSITORY, Column, Piece, Row
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
        value, quickest = ({"mean": figure[name]} for name in ("value", "quickest"))
        yield [f"`{key}`", value, quickest, figure["unit"]]


def _validation(runs: Runs) -> Iterator[Row]:
    """Of each check the measure that is nearest to its limit."""
    for number, name, what, value, *rest in runs.figures():
        yield [number, f"`{name}`", what, {"mean": value}, *rest]


PIECES = (
    Piece(
        "validation",
        {"": "python -m tests.mjforage.physics.validation.table"},
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
