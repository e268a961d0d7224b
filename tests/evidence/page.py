"""Regions of pages that are drawn from pieces: tables, their commands and where they come from.

A region stands between two comments, which no reader sees:

    <!-- evidence: NAME -->
    <!-- end of NAME -->
"""

import os
import re
from pathlib import Path

from tests.documents.blocks import MADE
from tests.evidence.marks import filled
from tests.evidence.piece import REPOSITORY, Piece, load
from tests.evidence.shown import shown

FEW = 3  # commands that a page shows unfolded
_REGION = re.compile(
    r"(?P<head>^<!-- evidence: (?P<name>[\w-]+) -->\n).*?(?P<end>^<!-- end of (?P=name) -->$)",
    re.M | re.S,
)


def names(page: str) -> list[str]:
    """Names of the regions of a page, in order."""
    return [found["name"] for found in _REGION.finditer((REPOSITORY / page).read_text("utf-8"))]


def renewed(page: str, text: str) -> str:
    """A page, a path from the repository's folder, its regions and marks as today's data are."""

    def put(found: re.Match[str]) -> str:
        data = f"docs/evidence/data/{found['name']}.json"
        drawn = region(load(found["name"]), os.path.relpath(data, Path(page).parent))
        return found["head"] + drawn + found["end"]

    return filled(_REGION.sub(put, text))


def region(piece: Piece, data: str) -> str:
    """The region of a piece, with a link to its data."""
    lines = ["| " + " | ".join(column.head for column in piece.columns) + " |"]
    lines.append("|" + "|".join("---" for _ in piece.columns) + "|")
    for row in piece.rows:
        cells = (shown(c, column) for c, column in zip(row.cells, piece.columns, strict=True))
        lines.append(f"| {' | '.join(cells)} |")
    made = piece.made or {}
    source = (
        f"*[Numbers]({data}) of mjforage {made['mjforage']}, commit {made['commit']}, "
        f"{made['date']}; `make evidence ONLY={piece.name}`.*"
    )
    return "\n\n".join([*_block(piece), "\n".join(lines), source]) + "\n"


def _block(piece: Piece) -> list[str]:
    if not piece.shown:
        return []
    commands = list(dict.fromkeys(run["command"] for run in piece.runs.values()))
    lines = "\n".join(commands)
    block = f"<!-- {MADE} -->\n```sh\n{lines}\n```"
    if len(commands) <= FEW:
        return [block]
    return [f"<details><summary>{len(commands)} commands</summary>\n\n{block}\n\n</details>"]
