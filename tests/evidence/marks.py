"""Numbers in sentences that are taken from pieces, between two comments that no reader sees:

    Greedy collects <!-- n: comb-port | greedy | PTA_C % -->83.6<!-- /n --> % of the items.

Piece, row and column are named. A row is named by one of its words, or by several with semicolons
between; an empty first cell has the word above it. A column is named by its head, the second of
one name by `#2` behind it. Then follow, if they differ from `mean` (`gap` where there is no mean)
and from the column's, a key of the cell, with a minus where words have the sign, and a form:
`| low .2f`, `| -gap`, `| mean .0%` for a hundredfold, `| gap +.1f` with a plus.
"""

import re

from tests.evidence.piece import Column, Piece, Row, load
from tests.evidence.shown import shown

MARK = re.compile(r"(?P<head><!-- n: (?P<spec>[^>]+) -->)(?P<text>[^<]*)(?P<end><!-- /n -->)")


def filled(text: str) -> str:
    """A page with the numbers of its marks as today's data are.

    Raises
    ------
    ValueError
        If a mark names no number of its piece, or several.
    KeyError
        If the number has no such key.
    """
    return MARK.sub(lambda found: f"{found['head']}{number(found['spec'])}{found['end']}", text)


def number(spec: str) -> str:
    """The number that a mark names, as text."""
    name, words, head, *rest = (part.strip() for part in spec.split("|"))
    piece = load(name)
    found = [(row, at) for row in _rows(piece, words) for at in _columns(piece, head)]
    if len(found) != 1:
        raise ValueError(f"mark {spec}: names {len(found)} cells, one expected")
    ((row, at),) = found
    cell = row.cells[at]
    field, _, layout = "".join(rest).partition(" ")
    if not isinstance(cell, dict):
        raise ValueError(f"mark {spec}: the cell is no number")
    wanted = field.removeprefix("-") or ("mean" if "mean" in cell else "gap")
    value = -cell[wanted] if field.startswith("-") else cell[wanted]
    form = layout or (".1g" if wanted == "n" else piece.columns[at].form)
    if form.endswith("%"):
        value, form = 100.0 * value, f"{form[:-1]}f"
    text = shown({"mean": value}, Column("", form.removeprefix("+")))
    return f"+{text}" if form[0] == "+" and value > 0 else text


def _rows(piece: Piece, words: str) -> list[Row]:
    """The rows that have all of some words."""
    wanted = {plain(word) for word in words.split(";")}
    first, found = "", []
    for row in piece.rows:
        texts = [cell for cell in row.cells if isinstance(cell, str)]
        first = texts[0] or first
        if wanted <= {plain(text) for text in (first, *texts)}:
            found.append(row)
    return found


def _columns(piece: Piece, head: str) -> list[int]:
    """Places of the columns of a head, of the second alone for `#2`."""
    name, _, which = head.partition("#")
    at = [i for i, column in enumerate(piece.columns) if plain(column.head) == plain(name)]
    return at[int(which) - 1 :][:1] if which else at


def plain(text: str) -> str:
    """Words without Markdown's emphasis, code and links."""
    return re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", text).replace("*", "").replace("`", "").strip()
