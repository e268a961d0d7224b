"""Regions of pages that are drawn from data: tables, their commands and where they come from.

A region stands between two comments, which no reader sees:

    <!-- evidence: NAME -->
    <!-- end of NAME -->
"""

import os
import re
from pathlib import Path

from mjforage.view.report.text_tables import NOTHING, needed_digits, number
from tests.documents.blocks import MADE, pages
from tests.evidence.data import Data
from tests.evidence.piece import Cell, Column, Piece

FEW = 3  # commands that a page shows unfolded
PAGES = pages()
_REGION = re.compile(
    r"(?P<head>^<!-- evidence: (?P<name>[\w-]+) -->\n).*?(?P<end>^<!-- end of (?P=name) -->$)",
    re.M | re.S,
)


def names(text: str) -> list[str]:
    """Names of the regions of a page, in order."""
    return [found["name"] for found in _REGION.finditer(text)]


def renewed(page: str, text: str, drawn: dict[str, str]) -> str:
    """Return a page with its regions as they are drawn; those of no piece stay.

    Parameters
    ----------
    page : path from the repository's folder, which links start from
    drawn : name -> text of a region; `{data}` in it becomes the link to the data
    """

    def put(found: re.Match[str]) -> str:
        body = drawn.get(found["name"])
        if body is None:
            return found[0]
        data = os.path.relpath(f"docs/evidence/data/{found['name']}.json", Path(page).parent)
        return found["head"] + body.replace("{data}", data) + found["end"]

    return _REGION.sub(put, text)


def region(piece: Piece, content: Data) -> str:
    """Draw the region of a piece from its data."""
    parts = [
        *([_block(piece)] if piece.shown else []),
        _table(piece, content),
        _source(piece, content),
    ]
    return "\n\n".join(parts) + "\n"


def _block(piece: Piece) -> str:
    lines = "\n".join(piece.runs.values())
    block = f"<!-- {MADE} -->\n```sh\n{lines}\n```"
    if len(piece.runs) <= FEW:
        return block
    return f"<details><summary>{len(piece.runs)} commands</summary>\n\n{block}\n\n</details>"


def _table(piece: Piece, content: Data) -> str:
    lines = [[column.head for column in piece.columns], ["---"] * len(piece.columns)]
    for row in content["rows"]:
        lines.append([shown(c, column) for c, column in zip(row, piece.columns, strict=True)])
    head, rule, *rest = lines
    rows = [f"| {' | '.join(head)} |", f"|{'|'.join(rule)}|"]
    return "\n".join(rows + [f"| {' | '.join(line)} |" for line in rest])


def _source(piece: Piece, content: Data) -> str:
    made = content["made"]
    again = f"`make evidence ONLY={piece.name}`"
    return (
        f"*[Numbers]({{data}}) of mjforage {made['mjforage']}, commit {made['commit']}, "
        f"{made['date']}; {again}.*"
    )


def shown(cell: Cell, column: Column) -> str:
    """A cell as pages show it."""
    if cell is None:
        return ""
    if isinstance(cell, str):
        return cell
    if column.significant:
        return _significant(cell, column.digits)
    digits = column.digits
    if "low" in cell:
        return _with_interval(cell, digits)
    if "gap" not in cell:
        half = f" ± {number(cell['half'], digits)}" if "half" in cell else ""
        return number(cell.get("mean", float("nan")), digits) + half
    if cell["gap"] == 0 and not cell.get("half"):
        return f"{number(cell['mean'], digits)} (0)" if "mean" in cell else "0"
    few = min(digits, needed_digits(cell.get("half", 0.0), digits))
    half = f" ± {number(cell['half'], few)}" if "half" in cell else ""
    difference = signed(cell["gap"], few) + half
    return f"{number(cell['mean'], digits)} ({difference})" if "mean" in cell else difference


def _with_interval(cell: dict[str, float], digits: int) -> str:
    """A difference or mean with its interval; a difference is bold where that leaves out 0."""
    low, high = cell["low"], cell["high"]
    if "gap" in cell:
        digits = needed_digits((high - low) / 2, digits)
    value = number(cell["gap"] if "gap" in cell else cell["mean"], digits)
    text = f"{value} ({number(low, digits)} to {number(high, digits)})"
    apart = round(low, digits) > 0 or round(high, digits) < 0
    return f"**{text}**" if "gap" in cell and apart else text


def _significant(cell: dict[str, float], digits: int) -> str:
    """A mean and its range to so many digits; whole where there are no more before the point."""
    if "mean" not in cell:
        return NOTHING
    value, *ends = (
        f"{one:,.0f}"
        if one == 0 or abs(one) >= 10 ** (digits - 1)
        else f"{one:#.{digits}g}".rstrip(".")
        for one in (cell[key] for key in ("mean", "low", "high") if key in cell)
    )
    text = f"{value} ({' to '.join(ends)})" if ends else value
    return text.replace("-", "−")


def signed(value: float, digits: int) -> str:
    """A number with its sign."""
    text = number(value, digits)
    return text if text[0] in "−–" else f"+{text}"
