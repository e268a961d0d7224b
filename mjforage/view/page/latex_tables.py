"""Tables in LaTeX for a paper: booktabs, small intervals, the best in bold.

The text compiles with pdflatex and the packages of `NEEDED`, whatever policies are called.
"""

import re
from collections.abc import Iterator, Sequence

from mjforage.base.references import file_label
from mjforage.view.page.marked_words import CODE, SUBSCRIPT
from mjforage.view.page.table import Row, Table, groups

NEEDED = ("adjustbox", "array", "booktabs")
WIDE = 4  # columns from which on intervals stand below their numbers
HEAD = 40  # letters of a row's head or a group's that is broken into lines

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
    """A table as LaTeX, to be read with input: a float, made smaller where a page has less room."""
    packages = ",".join(NEEDED)
    lines = [
        f"% needs \\usepackage[T1]{{fontenc}} and \\usepackage{{{packages}}}",
        r"\begin{table}[htbp]",
        r"\centering\small\setlength{\tabcolsep}{4pt}",
        rf"\caption{{{latex(table.title)}}}\label{{tab:{file_label(table.name)}}}",
        r"\begin{adjustbox}{max width=\linewidth, max totalheight=0.85\textheight}",
        rf"\begin{{tabular}}{{{_columns(table)}}}",
        r"\toprule",
        *_head(table),
        *_lines(table),
        r"\bottomrule",
        r"\end{tabular}",
        r"\end{adjustbox}",
        r"\end{table}",
        *_notes(table),
    ]
    return "\n".join(lines) + "\n"


def _columns(table: Table) -> str:
    heads = max((len(row.head) for row in table.rows), default=0)
    first = r">{\raggedright}p{0.36\linewidth}" if heads > HEAD else "l"
    return f"@{{}}{first}{'r' * len(table.columns)}@{{}}"


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
        yield _line([head, *means]) + "\n" + _line(["", *rests])
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
    return " " if sign.isspace() else rf"\texttt{{U+{ord(sign):04X}}}"
