"""Make evidence: `python -m tests.evidence [NAME ...] [--jobs N] [--pages] [--list]`.

Without a name all pieces are made whose numbers are not of this code; with names those, whatever
their numbers are of. Each piece's commands are run (folders in `runs/evidence`, which go on where
they were stopped), its numbers and files are written, and its regions of pages drawn. `--pages`
draws regions only.
"""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from mjforage.base.errors import UserError
from mjforage.view.page.figure import house_style, png_bytes, smaller
from mjforage.view.report.studies import communication
from mjforage.view.report.studies.board_page import write_board_page
from tests.documents.blocks import pages
from tests.evidence import trained, tutorials
from tests.evidence.page import renewed
from tests.evidence.piece import REPOSITORY, Piece, load, made, pieces, provenance, save
from tests.evidence.playing import RUNS, Runs, facts, play
from tests.evidence.tables import made_rows


def board(runs: Runs) -> None:
    """Write the page of the leaderboard and its pictures."""
    write_board_page(runs.folders[""], REPOSITORY / "docs/board.md")


def picture_of_links(runs: Runs) -> None:
    """PTA_C and NT90 along the axes of the study of communication."""
    drawn = (one for part in communication.sections(runs.study) for one in part.pictures)
    figure = next(one.figure for one in drawn if one.name == "axes-graph")
    with house_style():
        (REPOSITORY / "docs/communication.png").write_bytes(smaller(png_bytes(figure)))


FILES: dict[str, Callable[[Runs], None]] = {
    "board": board,
    "study-communication": picture_of_links,
    "family-seeds": trained.curves,
    "scores": tutorials.curves,
}
"""Pieces that write files: those that their `files` name."""


def draw() -> None:
    """Draw all regions of all pages."""
    for page in pages():
        text = (REPOSITORY / page).read_text("utf-8")
        if (new := renewed(page, text)) != text:
            (REPOSITORY / page).write_text(new, "utf-8")
            sys.stdout.write(f"{page}: drawn\n")


def make(piece: Piece, jobs: int = 1, runs: Path = RUNS) -> Piece:
    """Run what a piece needs in folders below `runs`, and return it with today's numbers.

    Raises
    ------
    UserError
        As its commands.
    """
    provenance()  # of the code that is now loaded, whatever is edited meanwhile
    folders = {}
    for label, run in piece.runs.items():
        sys.stderr.write(f"{piece.name}: {run['command']}\n")
        folders[label] = play(run["command"], jobs, runs)
    left = Runs(folders)
    if piece.name in FILES:
        FILES[piece.name](left)
    described = {
        label: {"command": run["command"]} | facts(folders[label])
        for label, run in piece.runs.items()
    }
    return made(piece, described, made_rows(piece, left))


def main() -> None:
    """Make, draw or list."""
    parser = argparse.ArgumentParser(prog="python -m tests.evidence", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help="of pieces; --list has them")
    parser.add_argument("--jobs", type=int, default=1, help="processes that compute")
    parser.add_argument("--pages", action="store_true", help="draw regions only, run nothing")
    parser.add_argument("--list", action="store_true", help="name the pieces, run nothing")
    chosen = parser.parse_args()
    if chosen.list:
        sys.stdout.write("".join(f"{name}\n" for name in pieces()))
        return
    for name in () if chosen.pages else chosen.names or pieces():
        piece = load(name)
        if chosen.names or not piece.current:
            try:
                save(make(piece, chosen.jobs))
            except UserError as error:
                sys.exit(f"evidence: {name}: {error}")
            draw()
    draw()


if __name__ == "__main__":
    main()
