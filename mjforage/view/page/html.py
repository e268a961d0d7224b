"""Sets a page: head, sections, tables and figures as HTML, nothing fetched from outside."""

import base64
import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from hashlib import sha256
from importlib import resources
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup, escape

from mjforage.base.references import file_label
from mjforage.view.page.figure import ReportFigure, save_figure, smaller
from mjforage.view.page.marked_words import CODE, SUBSCRIPT
from mjforage.view.page.table import Row, Table, groups
from mjforage.view.page.table_files import csv_text

_FOLDERS = ("page", "report")  # of templates


@dataclass(frozen=True)
class EmbeddedFigure:
    """A figure as the template sets it."""

    name: str
    title: str
    caption: str
    source: str  # data URI
    wide: bool
    width_px: int  # CSS pixels at natural size
    height_px: int


def embedded_within(
    budget: float, pictures: Sequence[ReportFigure], folder: Path
) -> list[EmbeddedFigure]:
    """Save figures in `figures` of a folder, and embed them: curves as SVG, maps as smaller PNG.

    Together they have `budget` characters at most if they can: the largest are embedded as PNG of
    few colours instead, until they fit; the files stay whole. Raises `UserError` if a file cannot
    be written.
    """
    saved = [save_figure(folder / "figures", picture) for picture in pictures]
    sources = [
        _data_uri("png", png) if picture.wide else _data_uri("svg+xml", svg)
        for picture, (png, svg) in zip(pictures, saved, strict=True)
    ]
    for i in sorted(range(len(sources)), key=lambda i: -len(sources[i])):
        if sum(map(len, sources)) <= budget:
            break
        sources[i] = min(sources[i], _data_uri("png", smaller(saved[i][0])), key=len)
    return [_shown(*pair) for pair in zip(pictures, sources, strict=True)]


def _data_uri(kind: str, content: bytes) -> str:
    return f"data:image/{kind};base64," + base64.b64encode(content).decode("ascii")


def _shown(picture: ReportFigure, source: str) -> EmbeddedFigure:
    width, height = (round(96 * size) for size in picture.figure.get_size_inches())
    words = picture.name, picture.title, picture.caption
    return EmbeddedFigure(*words, source, picture.wide, width, height)


def render_page(name: str, version: str, content: dict[str, Any]) -> str:
    """The page as HTML.

    Parameters
    ----------
    name : template that fills the blocks of `page.html.j2`
    version : of the mjforage that made the numbers
    content : what that template reads
    """
    files = {"stylesheet": Markup(_template("page.css")), "script": Markup(_template("tables.js"))}
    return environment().get_template(name).render(content, version=version, **files)


def environment() -> jinja2.Environment:
    """The templates with the filters that they use."""
    templates = jinja2.Environment(
        loader=jinja2.FunctionLoader(_template),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    used = (rich_text, interval_text, groups, sort_key, csv_uri, file_label, security)
    templates.filters.update({one.__name__: one for one in used})
    templates.globals["distinct"] = _distinct()
    return templates


def security(scripts: Sequence[str]) -> str:
    """The Content-Security-Policy of a page: nothing from outside, and no script but these.

    `scripts`: content of the page's script elements, to the letter.
    """
    digests = [sha256(script.encode("utf-8")).digest() for script in scripts]
    allowed = " ".join(f"'sha256-{base64.b64encode(one).decode('ascii')}'" for one in digests)
    return (
        f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )


def _distinct() -> Callable[[str], str]:
    """Function that numbers repeated labels of a page: those of landmarks must differ."""
    seen: Counter[str] = Counter()

    def label(words: str) -> str:
        seen[words] += 1
        return words if seen[words] == 1 else f"{words} ({seen[words]})"

    return label


def _template(name: str) -> str | None:
    """Text of a template or style sheet, from whichever folder has it."""
    for folder in _FOLDERS:
        file = resources.files("mjforage.view").joinpath(folder, *name.split("/"))
        if file.is_file():
            return file.read_text(encoding="utf-8")
    return None


def rich_text(text: str) -> Markup:
    """Escape, then set subscripts of metric names and code between backticks."""
    safe = str(escape(text))
    safe = SUBSCRIPT.sub(r"\1<sub>\2</sub>", safe)
    return Markup(CODE.sub(r"<code>\1</code>", safe))


def sort_key(row: Row, place: int) -> Markup:
    """Attribute of a cell by which its column is sorted; none for words, empty if undefined."""
    found = row.number(place)
    if found is None:
        return Markup()
    by = found.low if math.isnan(found.value) else found.value
    return Markup() if math.isnan(by) else Markup(' data-value="{}"').format(f"{by:.9g}")


def csv_uri(table: Table) -> str:
    """A table as CSV, as a data URI for a page that is one file."""
    content = base64.b64encode(csv_text(table).encode("utf-8")).decode("ascii")
    return f"data:text/csv;charset=utf-8;base64,{content}"


def interval_text(text: str) -> Markup:
    """Escape, and set what follows ± or an opening parenthesis smaller."""
    for sign in (" ± ", " ("):
        mean, found, rest = text.partition(sign)
        if found:
            return Markup("{}<small>{}{}</small>").format(mean, sign, rest)
    return escape(text)
