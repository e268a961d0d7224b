"""Tables in LaTeX for a paper: booktabs, intervals small, what is best in bold.

The text compiles with pdflatex and the packages of `NEEDED`, whatever policies are called.
"""

import re
import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import replace

from mjforage.base.references import file_label
from mjforage.view.page.marked_words import CODE, SUBSCRIPT
from mjforage.view.page.table import Row, Table, groups

NEEDED = ("array", "booktabs", "graphicx", "longtable")
LONG = 44  # lines of a table that is no float, so that it may go over pages
WIDE = 4  # columns from which on intervals stand below their numbers
HEAD = 40  # letters of a row's head or a group's that is broken into lines

LINE, GAP = 84, 2  # letters that a line has in the small print of wide tables, and between columns

_SIGNS = {
    **{sign: f"\\{sign}" for sign in "&%$#_{}"},
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"$<$",
    ">": r"$>$",
    "|": r"\textbar{}",
    '"': r"\textquotedbl{}",
    "[": "{[}",  # after the end of a line it would begin an option
    "]": "{]}",
    "*": "{*}",
    "–": r"\textendash{}",
    "−": r"$-$",
    "±": r"$\pm$",
    "≈": r"$\approx$",
    "×": r"$\times$",
    "·": r"$\cdot$",
    "≥": r"$\ge$",
    "≤": r"$\le$",
    "Δ": r"$\Delta$",
    "ε": r"$\varepsilon$",
    "°": r"$^\circ$",
}
_LATIN = re.compile("[\x20-\x7eÀ-ÖØ-öø-ÿ]")  # what pdflatex sets from UTF-8 as it is
_DASHES = re.compile("-(?=-)")  # which would become one
_PAIR = re.compile(r"(?P<mean>.+?)(?P<rest> (?:±|\().+)", re.DOTALL)


def latex_text(table: Table) -> str:
    """A table as LaTeX, to be read with input: a float, or where it is long a `longtable`.

    A float is made smaller where the line is too short for it; a `longtable` that is too wide
    becomes several, each with some of the columns.
    """
    packages = ",".join(NEEDED)
    first = f"% needs \\usepackage[T1]{{fontenc}} and \\usepackage{{{packages}}}"
    lines = list(_lines(table))
    if len(lines) <= LONG:
        return "\n".join([first, *_float(table, lines)]) + "\n"
    parts = [line for part in _parts(table) for line in _long(part)]
    return "\n".join([first, *parts, *_notes(table)]) + "\n"


def _parts(table: Table) -> list[Table]:
    """A long table, or where it is too wide some that have all of its rows and not all columns."""
    if len(table.columns) <= WIDE:
        return [table]
    heads = max(len(row.head) for row in table.rows)
    first = HEAD if heads > HEAD else heads
    parts: list[list[int]] = [[]]
    used = first
    for place in range(len(table.columns)):
        letters = _letters(table, place) + GAP
        if parts[-1] and used + letters > LINE:
            parts.append([])
            used = first
        parts[-1].append(place)
        used += letters
    return [_part(table, places, number) for number, places in enumerate(parts)]


def _letters(table: Table, place: int) -> int:
    """How wide a column is, intervals below their numbers."""
    words = [table.columns[place].replace("_", "") + " x" * any(table.better)]
    words += table.units[place : place + 1]
    words += [part for row in table.rows for part in _parted(row.cells[place])]
    return max(map(len, words))


def _part(table: Table, places: Sequence[int], number: int) -> Table:
    """Some of the columns; the first part keeps the name that is referred to."""
    rows = tuple(
        replace(
            row,
            cells=tuple(row.cells[place] for place in places),
            best=frozenset(new for new, place in enumerate(places) if place in row.best),
            values=(),
            also=(),
        )
        for row in table.rows
    )
    return replace(
        table,
        name=f"{table.name}-{number + 1}" if number else table.name,
        title=f"{table.title} (continued)" if number else table.title,
        columns=tuple(table.columns[place] for place in places),
        rows=rows,
        units=tuple(table.units[place] for place in places) if table.units else (),
        better=tuple(table.better[place] for place in places) if table.better else (),
        stacked=True,
    )


def _float(table: Table, lines: Sequence[str]) -> list[str]:
    return [
        r"\begin{table}",
        r"\centering\small\setlength{\tabcolsep}{4pt}",
        _caption(table),
        r"\resizebox{\ifdim\width>\linewidth\linewidth\else\width\fi}{!}{%",
        rf"\begin{{tabular}}{{{_columns(table)}}}",
        r"\toprule",
        *_head(table),
        *lines,
        r"\bottomrule",
        r"\end{tabular}}",
        *_notes(table),
        r"\end{table}",
    ]


def _long(table: Table) -> list[str]:
    """Stacked ones are small, and so are their intervals."""
    size, fine = (r"\scriptsize", r"\tiny") if table.stacked else (r"\small", r"\footnotesize")
    head, lines = (
        [line.replace(r"{\footnotesize ", rf"{{{fine} ") for line in part]
        for part in ([r"\toprule", *_head(table)], _lines(table))
    )
    return [
        rf"{{{size}\setlength{{\tabcolsep}}{{4pt}}",
        rf"\begin{{longtable}}{{{_columns(table)}}}",
        _caption(table) + r" \\",
        *head,
        r"\endfirsthead",
        *head,
        r"\endhead",
        r"\bottomrule",
        r"\endfoot",
        *lines,
        r"\end{longtable}",
        "}",
    ]


def _columns(table: Table) -> str:
    heads = max((len(row.head) for row in table.rows), default=0)
    first = r">{\raggedright}p{0.36\linewidth}" if heads > HEAD else "l"
    return f"@{{}}{first}{'r' * len(table.columns)}@{{}}"


def _caption(table: Table) -> str:
    return rf"\caption{{{latex(table.title)}}}\label{{tab:{file_label(table.name)}}}"


def _notes(table: Table) -> Iterator[str]:
    for note in table.notes:
        yield rf"\par\smallskip{{\footnotesize\raggedright {latex(note)}\par}}"


def _head(table: Table) -> Iterator[str]:
    """Labels, an arrow to what is better, and units below them where there are any."""
    better = table.better or (0,) * len(table.columns)
    arrows = [{1: r" $\uparrow$", -1: r" $\downarrow$", 0: ""}[one] for one in better]
    heads = (latex(one) + arrow for one, arrow in zip(table.columns, arrows, strict=True))
    yield _line([latex(table.head), *heads])
    if any(table.units):
        units = (rf"{{\footnotesize {latex(unit)}}}" if unit else "" for unit in table.units)
        yield _line(["", *units])
    yield r"\midrule"


def _lines(table: Table) -> Iterator[str]:
    for place, (first, rows) in enumerate(groups(table.rows)):
        if place:
            yield r"\addlinespace"
        if first.group:
            wrapped = len(first.group) > HEAD
            yield _across(table, rf"\textit{{{latex(first.group)}}}", wrapped=wrapped)
        if first.note:
            yield _across(table, rf"\footnotesize {latex(first.note)}", wrapped=True)
        for row in rows:
            yield from _row(row, stacked=table.stacked or len(table.columns) > WIDE)


def _across(table: Table, text: str, *, wrapped: bool = False) -> str:
    """A line over all columns; words that need more than one line wrap."""
    shape = r"@{}p{0.95\linewidth}@{}" if wrapped else "@{}l@{}"
    return rf"\multicolumn{{{len(table.columns) + 1}}}{{{shape}}}{{{text}}} \\"


def _row(row: Row, *, stacked: bool) -> Iterator[str]:
    """One line, or with `stacked` a second one with the intervals."""
    head = rf"\textit{{{latex(row.head)}}}" if row.paper else latex(row.head)
    pairs = [_parted(cell) for cell in row.cells]
    means = [
        rf"\textbf{{{latex(mean)}}}" if place in row.best else latex(mean)
        for place, (mean, _) in enumerate(pairs)
    ]
    rests = [rf"{{\footnotesize {latex(rest)}}}" if rest else "" for _, rest in pairs]
    if stacked and any(rests):
        yield _line([head, *means]) + "*"  # no page may end here
        yield _line(["", *rests])
    else:
        yield _line([head, *(f"{m} {r}" if r else m for m, r in zip(means, rests, strict=True))])


def _parted(cell: str) -> tuple[str, str]:
    """A number, and its interval behind ± or in parentheses."""
    found = _PAIR.fullmatch(cell)
    return (found["mean"], found["rest"].strip()) if found else (cell, "")


def _line(cells: Sequence[str]) -> str:
    return " & ".join(cells) + r" \\"


def latex(text: str) -> str:
    """Words as LaTeX: signs escaped, subscripts of metrics and code between backticks set."""
    parts = []
    for place, part in enumerate(CODE.split(text)):
        if place % 2:
            parts.append(rf"\texttt{{{_escaped(part)}}}")
        else:
            parts.append(_with_subscripts(part))
    return "".join(parts)


def _with_subscripts(text: str) -> str:
    found, end = [], 0
    for match in SUBSCRIPT.finditer(text):
        stem, below = match.groups()
        found += [_escaped(text[end : match.start()]), rf"{stem}\textsubscript{{{below}}}"]
        end = match.end()
    return "".join([*found, _escaped(text[end:])])


def _escaped(text: str) -> str:
    return _DASHES.sub("-{}", "".join(_SIGNS.get(sign) or _set(sign) for sign in text))


def _set(sign: str) -> str:
    """A sign that needs no escape; one that the fonts lack by its code point."""
    if _LATIN.fullmatch(sign):
        return sign
    if sign.isspace():
        return " "
    plain = unicodedata.normalize("NFKC", sign)
    if plain == sign or not plain.isascii():
        return rf"\texttt{{U+{ord(sign):04X}}}"
    return "".join(_SIGNS.get(one, one) for one in plain)
