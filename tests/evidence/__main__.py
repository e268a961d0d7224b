"""Make evidence: `python -m tests.evidence [NAME ...] [--jobs N] [--pages] [--list]`.

Without a name all pieces are made whose data are not of this code; with names those, whatever their
data are of. Each piece's commands are run (folders in `runs/evidence`, which go on where they were
stopped), its data are written, and its regions of pages drawn. `--pages` draws regions only.
"""

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from mjforage.base.atomic_files import write_bytes
from mjforage.base.errors import UserError
from tests.evidence import data
from tests.evidence.page import PAGES, names, region, renewed
from tests.evidence.piece import REPOSITORY, Piece
from tests.evidence.pieces import PIECES
from tests.evidence.playing import RUNS, play


def draw() -> list[str]:
    """Draw all regions of all pages from data, and return the pages that changed."""
    drawn = {
        name: region(piece, data.load(piece))
        for name, piece in PIECES.items()
        if piece.columns and data.file_of(piece).exists()
    }
    changed = []
    for page in PAGES:
        file = REPOSITORY / page
        text = file.read_text("utf-8")
        new = renewed(page, text, drawn)
        if new != text:
            write_bytes(file, new.encode())
            changed.append(page)
    return changed


def make(piece: Piece, jobs: int = 1, runs: Path = RUNS, folder: Path = data.DATA) -> None:
    """Run what a piece needs in folders below `runs`, and write its data.

    Raises
    ------
    UserError
        As its commands.
    """
    data.provenance()  # of the code that is now loaded, whatever is edited meanwhile
    folders = {}
    for number, (label, command) in enumerate(piece.runs.items(), 1):
        said = f"{piece.name}, {number} of {len(piece.runs)}: {command}\n"
        sys.stderr.write(said)
        folders[label] = play(command, jobs, runs)
    data.save(piece, data.gathered(piece, folders), folder)


def overview() -> str:
    """A line for each piece: minutes of one core, by what its data are made, name and pages."""
    lines = []
    for name, piece in PIECES.items():
        content = data.load(piece)
        measured = data.cpu_minutes(content)
        minutes = f"about {piece.minutes:.0f}" if measured is None else f"{measured:.0f}"
        made = content["made"]
        whence = f"{made['commit']} {made['date']}"
        places = [page for page in PAGES if name in names((REPOSITORY / page).read_text("utf-8"))]
        where = ", ".join((*places, *piece.files))
        lines.append(f"{name:24}{minutes:>10} min  {whence:26}{where}\n")
    return "".join(lines)


def main(arguments: Sequence[str] | None = None) -> None:
    """Make, draw or list."""
    parser = argparse.ArgumentParser(prog="python -m tests.evidence", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help="of pieces; --list has them")
    parser.add_argument("--jobs", type=int, default=1, help="processes that compute")
    parser.add_argument("--pages", action="store_true", help="draw regions from data, run nothing")
    parser.add_argument("--list", action="store_true", help="name the pieces, run nothing")
    chosen = parser.parse_args(arguments)
    if unknown := sorted(set(chosen.names) - set(PIECES)):
        sys.exit(f"evidence: {', '.join(unknown)} unknown; --list names the pieces")
    if chosen.list:
        sys.stdout.write(overview())
        return
    wanted = [PIECES[name] for name in chosen.names or PIECES]
    for piece in () if chosen.pages else wanted:
        if not chosen.names and data.current(piece):
            continue
        begun = time.monotonic()
        try:
            make(piece, chosen.jobs)
        except UserError as error:
            sys.exit(f"evidence: {piece.name}: {error}")
        draw()
        sys.stderr.write(f"{piece.name}: made in {(time.monotonic() - begun) / 60:.1f} min\n")
    for page in draw():
        sys.stdout.write(f"{page}: drawn\n")


if __name__ == "__main__":
    main()
