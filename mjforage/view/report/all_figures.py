"""All figures of the report, drawn under one style, and their files."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import matplotlib as mpl

from mjforage.core.whole_files import write_bytes
from mjforage.view.report import style
from mjforage.view.report.curves import time_figures
from mjforage.view.report.distributions import distribution_figures
from mjforage.view.report.map_figures import scenario_figure
from mjforage.view.report.picture import Picture, png_bytes, svg_bytes
from mjforage.view.report.run_logs import RunLogs, pick_replay
from mjforage.view.report.track_figure import tracks_figure


@contextmanager
def house_style() -> Iterator[None]:
    """Draw in the project's style inside the block; matplotlib's settings come back after it."""
    with mpl.rc_context(style.RC):
        yield


def draw_figures(logs: RunLogs) -> list[Picture]:
    """Draw every figure, in the order of the report: scenario, tracks, curves, distributions."""
    with house_style():
        return [
            scenario_figure(logs, pick_replay(logs)),
            tracks_figure(logs),
            *time_figures(logs),
            *distribution_figures(logs),
        ]


def save_figure(folder: Path, picture: Picture) -> tuple[bytes, bytes]:
    """Write ``<name>.png`` (150 dpi) and ``<name>.svg`` into the folder.

    Returns
    -------
    tuple of bytes
        The PNG and the SVG, for embedding.

    Raises
    ------
    UserError
        If a file cannot be written.
    """
    with house_style():
        svg, png = svg_bytes(picture.figure), png_bytes(picture.figure)
    write_bytes(folder / f"{picture.name}.svg", svg)
    write_bytes(folder / f"{picture.name}.png", png)
    return png, svg
