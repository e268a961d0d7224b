"""Figures of the validation report: curves that are told apart without their colours too."""

import numpy as np
from matplotlib.colors import to_hex
from matplotlib.lines import Line2D

from mjforage.physics.validation.finding import Finding, Line, Panel
from mjforage.view.page import style
from mjforage.view.validation.curves_figure import draw

X = np.arange(1.0, 30.0)


def drawn(*lines: Line) -> dict[str, Line2D]:
    panel = Panel("title", "x (s)", "y (m)", lines)
    figure = draw(Finding("a", "1", "A", "Shows.", (), (panel,))).figure
    axes = figure.axes[0]
    return {line.label: shown for line, shown in zip(lines, axes.lines, strict=True)}


def look(line: Line2D) -> tuple[str, str, str]:
    return to_hex(line.get_color()), str(line.get_marker()), str(vars(line)["_dash_pattern"])


def test_two_expected_laws_differ_in_colour_and_dashes_and_go_with_what_is_measured() -> None:
    lines = drawn(
        Line("reference", X, X**4, 0, points=True),
        Line("order 4", X, X**4, 0, expected=True),
        Line("fast", X, X**2, 1, points=True),
        Line("order 2", X, X**2, 1, expected=True),
    )
    four, two = look(lines["order 4"]), look(lines["order 2"])
    assert four[0] != two[0] and four[2] != two[2]
    assert four[0] == look(lines["reference"])[0]
    assert two[0] == look(lines["fast"])[0]
    assert lines["reference"].get_marker() != lines["fast"].get_marker()


def test_one_expected_law_is_in_ink_for_all_cases() -> None:
    lines = drawn(
        Line("one", X, X, 0),
        Line("", X, X, 1, expected=True),
        Line("two", X, X, 1),
        Line("law", X, X, expected=True),
    )
    for label in ("", "law"):
        assert look(lines[label])[0] == style.INK.lower()
    assert look(lines["one"])[1] != look(lines["two"])[1], "several cases have markers"
