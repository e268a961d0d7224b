"""Tables in LaTeX for a paper: booktabs, small intervals, the best in bold.

The text compiles with pdflatex and the packages of `NEEDED`, whatever policies are called.
"""

import re
from collections.abc import Iterator, Sequence
from importlib import resources

import jinja2

from mjforage.base.references import file_label
from mjforage.view.page.marked_words import CODE, SUBSCRIPT
from mjforage.view.page.table import Row, Table, groups

NEEDED = ("adjustbox", "array", "booktabs")
WIDE = 4  # columns from which on intervals stand below their numbers
HEAD = 40  # letters from which the head of a row or group is broken into lines

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
    templates = jinja2.Environment(
        block_start_string="<%",
        block_end_string="%>",
        variable_start_string="<<",
        variable_end_string=">>",
        trim_blocks=True,
        keep_trailing_newline=True,
        undefined=jinja2.StrictUndefined,
    )
    templates.filters.update(latex=latex, line=_line, lines=_lines, groups=groups, label=file_label)
    better = table.better or (0,) * len(table.columns)
    arrows = [{1: r" $\uparrow$", -1: r" $\downarrow$", 0: ""}[one] for one in better]
    file = resources.files("mjforage.view").joinpath("page", "table.tex.j2")
    text: str = templates.from_string(file.read_text(encoding="utf-8")).render(
        table=table,
        packages=NEEDED,
        heads=[latex(one) + arrow for one, arrow in zip(table.columns, arrows, strict=True)],
        units=[_small(unit) for unit in table.units] if any(table.units) else [],
        stacked=table.stacked or len(table.columns) > WIDE,
        most=HEAD,
        long=max((len(row.head) for row in table.rows), default=0) > HEAD,
    )
    return text


def _lines(row: Row, stacked: bool) -> Iterator[list[str]]:
    """Cells of one line, or with `stacked` of a second one with the intervals."""
    head = rf"\textit{{{latex(row.head)}}}" if row.paper else latex(row.head)
    pairs = [_parted(cell) for cell in row.cells]
    means = [
        rf"\textbf{{{latex(mean)}}}" if place in row.best else latex(mean)
        for place, (mean, _) in enumerate(pairs)
    ]
    rests = [_small(rest) for _, rest in pairs]
    if stacked and any(rests):
        yield [head, *means]
        yield ["", *rests]
    else:
        yield [head, *(f"{m} {r}" if r else m for m, r in zip(means, rests, strict=True))]


def _parted(cell: str) -> tuple[str, str]:
    """A number, and its interval behind ± or in parentheses."""
    found = _PAIR.fullmatch(cell)
    return (found["mean"], found["rest"].strip()) if found else (cell, "")


def _small(text: str) -> str:
    return rf"{{\footnotesize {latex(text)}}}" if text else ""


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
