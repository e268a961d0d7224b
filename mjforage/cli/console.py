"""Parts that commands share: the app, the streams, and lists."""

import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TextIO

import cyclopts
from cyclopts import Parameter
from rich.console import Console
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from mjforage import __version__

NARROW = 60  # [columns] below which help has no frames, which would cut the names of flags
PIPE_COLUMNS = 400  # tables keep their natural width where stdout is no terminal

OUT = Parameter(name=("--out", "-o"), alias="--output")
"""The flag of every command that writes a file."""


def _names_no_page(kind: object, folder: Path | None) -> None:
    """Refuse a new folder that is named as the page in it."""
    if folder is not None and folder.suffix.lower() in (".html", ".htm") and not folder.is_dir():
        raise ValueError(f"It is a folder, for report.html and more; give --out {folder.stem}")


FOLDER = Parameter(name=OUT.name, alias=OUT.alias, validator=_names_no_page)
"""The same flag of every command that writes a folder."""

app = cyclopts.App(
    name="mjforage",
    version=__version__,
    version_flags=("--version", "-V"),
    help="Cooperative foraging by autonomous surface vehicles: run, measure, compare, look.",
    help_format="plaintext",
    suppress_keyboard_interrupt=False,
)


def _is_terminal(stream: TextIO | None) -> bool:
    """True if the stream is a terminal, whatever variables say of colours."""
    return stream is not None and stream.isatty()


output = Console(markup=False, emoji=False, highlight=False)
if not _is_terminal(sys.stdout) and not os.environ.get("COLUMNS", "").strip("0").isdigit():
    output.width = PIPE_COLUMNS
if output.width < NARROW:
    app.help_formatter = "plain"
errors = Console(stderr=True, soft_wrap=True, emoji=False, highlight=False)
errors.is_interactive &= _is_terminal(sys.stderr)


def print_file(path: Path, *more: str) -> None:
    """Print a file to be copied, in UTF-8 as all are, and what is to follow: without the line by
    which editors find the schema of one that ships.
    """
    lines = path.read_text("utf-8").splitlines(keepends=True)
    own = [line for line in lines if not line.startswith("#:schema ../schemas/")]
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(encoding="utf-8")
    sys.stdout.write("".join((*own, *more)))


def print_list(rows: Iterable[tuple[str, str]]) -> None:
    """Print names with their descriptions."""
    table = Table(box=None, show_header=False, pad_edge=False)
    for name, words in rows:
        table.add_row(Text(name, style="bold"), Text(words))
    print_table(table)


def print_table(table: Table) -> None:
    """Print a table; on a terminal too narrow for its words and numbers, line by line."""
    anywhere = output.options.update(max_width=PIPE_COLUMNS)
    if Measurement.get(output, anywhere, table).minimum <= output.width:
        output.print(table)
        return
    if table.title:
        output.print(table.title)
    heads = [_line_of(column.header) for column in table.columns]
    for first, *rest in zip(*(column.cells for column in table.columns), strict=True):
        output.print(_line_of(first))
        for head, cell in zip(heads[1:], map(_line_of, rest), strict=True):
            output.print(f"  {head}: {cell}" if head else f"  {cell}")


def _line_of(cell: object) -> str:
    return " ".join(str(cell).split())
