"""What commands share: the app, where words go, progress bars and lists."""

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import cyclopts
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from mjforage import __version__

PIPE_COLUMNS = 400  # tables keep their natural width where stdout is no terminal

app = cyclopts.App(
    name="mjforage",
    version=__version__,
    help="Cooperative foraging by autonomous surface vehicles: run, measure, compare, look.",
    help_format="plaintext",
    suppress_keyboard_interrupt=False,
)

output = Console(markup=False, emoji=False, highlight=False)
if not output.is_terminal and "COLUMNS" not in os.environ:
    output.width = PIPE_COLUMNS
errors = Console(stderr=True, soft_wrap=True, emoji=False, highlight=False)


@contextmanager
def bar(words: str) -> Iterator["Bar"]:
    """A progress bar on a terminal; nothing elsewhere."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    hidden = not errors.is_terminal
    with Progress(*columns, console=errors, transient=True, disable=hidden) as progress:
        yield Bar(progress, words)


class Bar:
    """A progress bar that appears with the first report."""

    def __init__(self, progress: Progress, words: str) -> None:
        self._progress, self._words = progress, words
        self._task = progress.add_task(words, total=None)

    def __call__(self, done: int, total: int) -> None:
        """Show that `done` of `total` are finished."""
        self._progress.update(self._task, completed=done, total=total)


def print_list(rows: Iterable[tuple[str, str]]) -> None:
    """Print names and what they are."""
    table = Table(box=None, show_header=False, pad_edge=False)
    for name, words in rows:
        table.add_row(Text(name, style="bold"), Text(words))
    output.print(table)
