"""Parts of every figure: its record, canvas, legend and files."""

import io
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from PIL import Image

from mjforage.base.atomic_files import write_bytes
from mjforage.base.references import file_label
from mjforage.view.page import style

WIDTH_IN = 5.6  # half a page of the report
WIDE_IN = 11.2  # a whole page
DPI = 150  # of a PNG, and of maps inside an SVG
SCREEN_DPI = 100  # of a picture in a notebook
COLOURS = 48  # of a PNG that is kept in a repository

_WORDS = r"[A-Za-z0-9 ,.()-]+"
_POWER = r"\\mathdefault\{(?:[\d.]+\\times)?\d+\^\{[-−]?\d+\}\}"  # matplotlib's, of logarithms
_MATHEMATICS = re.compile(rf"\$(?:t/T|T|C_R|_\{{\\mathrm\{{{_WORDS}\}}\}}|{_POWER})\$")


@dataclass(frozen=True)
class ReportFigure:
    """A drawn figure with its words. `title` and `caption` are plain text."""

    name: str  # as `file`, its file stem in figures/
    title: str
    caption: str
    figure: Figure
    wide: bool = False  # takes the whole width of the page

    @property
    def file(self) -> str:
        """Its name as that of a file: names of metrics are of anybody's run."""
        return file_label(self.name)


@dataclass(frozen=True)
class Panel:
    """Canvas and legend entries of one figure over policies and worlds."""

    policies: tuple[str, ...]
    worlds: tuple[str, ...]

    def styles(self) -> dict[str, style.PolicyStyle]:
        """Colour and marker per policy."""
        return style.policy_styles(self.policies)

    def lines(self) -> dict[str, style.Line]:
        """Line style per world."""
        return style.world_lines(self.worlds)

    def legend(self, figure: Figure) -> None:
        """Draw the legend above the axes: policies and, for several worlds, their lines."""
        handles = [self._handle(name, look) for name, look in self.styles().items()]
        if len(self.worlds) > 1:
            handles += [
                Line2D([], [], color=style.INK, linestyle=line, label=f"{world} world")
                for world, line in self.lines().items()
            ]
        longest = max(len(str(handle.get_label())) for handle in handles)
        columns = max(1, min(len(handles), int(WIDTH_IN / (0.55 + 0.09 * longest))))
        figure.legend(
            handles=handles,
            loc="outside upper left",
            ncols=columns,
            columnspacing=1.4,
            handlelength=1.8,
        )

    def _handle(self, name: str, look: style.PolicyStyle) -> Line2D:
        line = self.lines()[self.worlds[0]] if len(self.worlds) == 1 else "-"
        look_of: dict[str, Any] = {"color": look.colour, "linestyle": line, "marker": look.marker}
        return Line2D([], [], markersize=5, label=name, **look_of)


class Picture(Figure):
    """A figure that a notebook shows as a picture, with no pyplot state."""

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        with house_style():
            self.savefig(buffer, format="png", dpi=SCREEN_DPI)
        return buffer.getvalue()


def canvas(width_in: float, height_in: float) -> Picture:
    """Return an empty figure bound to the Agg canvas."""
    figure = Picture(figsize=(width_in, height_in), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def mathtext(label: str) -> str:
    """A label with the words after its underscore as a subscript."""
    stem, _, below = label.partition("_")
    plain = re.fullmatch(_WORDS, below) and "$" not in stem
    return f"{stem}$_{{\\mathrm{{{below}}}}}$" if plain else label


def literal(figure: Figure) -> None:
    """Let no text of a figure be mathematics but ours: labels are of anybody's run.

    Numbers on an axis are matplotlib's own; those of a logarithmic one are mathematics.
    """
    for text in figure.findobj(Text):
        assert isinstance(text, Text)
        text.set_parse_math("$" not in _MATHEMATICS.sub("", text.get_text()))


def undefined(axes: Axes, what: str, words: str) -> None:
    """Write into empty axes the reason why they are empty."""
    axes.set(ylim=(0.0, 1.0), yticks=[])
    axes.text(
        0.5,
        0.5,
        f"{what} {words}",
        transform=axes.transAxes,
        ha="center",
        va="center",
        color=style.MUTED,
    )


def joined(words: Sequence[str]) -> str:
    """Join words with commas and a final 'and'."""
    if len(words) < 2:
        return "".join(words)
    return ", ".join(words[:-1]) + " and " + words[-1]


def svg_bytes(figure: Figure, *, as_text: bool = False) -> bytes:
    """Render to SVG with no date and salted ids, so that equal figures give equal bytes.

    Letters are outlines, the same on every machine; with `as_text` they are text, to be edited.
    """
    metadata: dict[str, Any] = {"Date": None, "Creator": None}
    letters = {"svg.fonttype": "none"} if as_text else {}
    return _printed(figure, letters, format="svg", metadata=metadata)


def pdf_bytes(figure: Figure) -> bytes:
    """Render to PDF without a date, its letters as text in TrueType."""
    metadata: dict[str, Any] = {"CreationDate": None, "Creator": None, "Producer": None}
    return _printed(figure, {"pdf.fonttype": 42}, format="pdf", metadata=metadata)


def png_bytes(figure: Figure) -> bytes:
    """Render to PNG at 150 dpi, without the software stamp."""
    return _printed(figure, {}, format="png", metadata={"Software": None})


def smaller(content: bytes) -> bytes:
    """A PNG with few colours: a third of the bytes, for a page that is kept in a repository."""
    buffer = io.BytesIO()
    with Image.open(io.BytesIO(content)) as image:
        few = image.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
        few.save(buffer, "PNG", optimize=True)
    return buffer.getvalue()


def _printed(figure: Figure, letters: dict[Any, Any], **options: Any) -> bytes:
    """Print a figure, laid out once for whatever it is printed on.

    With a layout engine left in the figure, matplotlib would draw all of it twice.
    """
    buffer, engine = io.BytesIO(), figure.get_layout_engine()
    with mpl.rc_context(style.RC):
        literal(figure)
        figure.set_dpi(DPI)
        if engine is not None:
            FigureCanvasAgg(figure)
            engine.execute(figure)
            figure.set_layout_engine(None)
        with mpl.rc_context(letters):
            figure.savefig(buffer, dpi=DPI, **options)
    return buffer.getvalue()


@contextmanager
def house_style() -> Iterator[None]:
    """Draw in the project's style inside the block; matplotlib's settings come back after it."""
    with mpl.rc_context(style.RC):
        yield


def save_figure(folder: Path, picture: ReportFigure) -> tuple[bytes, bytes]:
    """Write ``<name>.png`` (150 dpi) and ``<name>.svg`` into the folder.

    Raises `UserError` if a file cannot be written.

    Returns: the PNG and the SVG, for embedding.
    """
    with house_style():
        svg, png = svg_bytes(picture.figure), png_bytes(picture.figure)
    write_bytes(folder / f"{picture.file}.svg", svg)
    write_bytes(folder / f"{picture.file}.png", png)
    return png, svg
