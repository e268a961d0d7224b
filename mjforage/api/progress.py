"""Progress of a call: a bar where a person is watching, else nothing."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

Report = Callable[[int, int], None]


def is_notebook() -> bool:
    """True in the process of a notebook."""
    return "ipykernel" in sys.modules


@contextmanager
def bar(words: str, unit: str, wanted: bool | Report | None) -> Iterator[Report]:
    """Show the share that is done.

    Parameters
    ----------
    words : name of the work, such as "evaluate"
    unit : counted unit, such as "episodes"
    wanted : True shows a bar, a function is called itself; None: a bar where a person is watching

    Yields
    ------
    what is called with (done, total)
    """
    watched = is_notebook() or (sys.stderr is not None and sys.stderr.isatty())
    if callable(wanted):
        yield wanted
    elif not (watched if wanted is None else wanted):
        yield lambda done, total: None
    elif is_notebook():
        yield from _notebook_bar(words, unit)
    else:
        from rich.console import Console
        from rich.progress import Progress

        with Progress(console=Console(stderr=True), transient=True) as shown:
            task = shown.add_task(f"{words}, {unit}", total=None)
            yield lambda done, total: shown.update(task, completed=done, total=total)


def _notebook_bar(words: str, unit: str) -> Iterator[Report]:
    """A bar of the notebook itself, which needs no widgets; gone when the work is done."""
    screen: Any = import_module("IPython.display")
    shown = screen.display(screen.HTML(""), display_id=True)

    def report(done: int, total: int) -> None:
        text = f"{words}: {done} of {total} {unit}"
        shown.update(screen.HTML(f'<progress value="{done}" max="{total}"></progress> {text}'))

    try:
        yield report
    finally:
        shown.update(screen.HTML(""))
