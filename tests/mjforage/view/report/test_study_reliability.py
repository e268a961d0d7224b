"""Reliability diagrams, on bins written by hand."""

import numpy as np

from mjforage.view.report.studies.reliability import Bins, reliability_picture

RIGHT = Bins(np.array([0.05, 0.5, 0.95]), np.array([0.0, 0.5, 1.0]), np.array([900, 40, 7]))
EMPTY = Bins(np.array([0.1, np.nan]), np.array([0.4, np.nan]), np.array([30, 0]))


def test_bins_are_dots_of_forecast_and_observed_and_empty_ones_are_left_out() -> None:
    drawn = reliability_picture("r", "T", "C.", {"right": RIGHT, "too low": EMPTY})
    above, below = drawn.figure.axes
    lines = {line.get_label(): line for line in above.lines}
    assert np.asarray(lines["right"].get_xydata()).tolist() == [[0.05, 0], [0.5, 0.5], [0.95, 1]]
    assert np.asarray(lines["too low"].get_xydata()).tolist() == [[0.1, 0.4]]
    counts = [np.ravel(line.get_ydata()).tolist() for line in below.lines]
    assert counts == [[900, 40, 7], [30]]
    assert lines["right"].get_color() == below.lines[0].get_color()
    assert lines["right"].get_color() != lines["too low"].get_color()
    texts = [text.get_text() for text in drawn.figure.legends[0].get_texts()]
    assert texts == ["right", "too low"]


def test_what_is_certain_is_inside_the_panel_and_axes_are_per_cent() -> None:
    above, below = reliability_picture("r", "T", "C.", {"right": RIGHT}).figure.axes
    assert above.get_xlim()[0] < 0 and above.get_ylim()[1] > 1
    assert above.yaxis.get_major_formatter()(0.2, 0) == "20"
    assert below.get_yscale() == "log"


def test_more_kinds_than_colours_are_all_drawn() -> None:
    drawn = reliability_picture("r", "T", "C.", {str(i): RIGHT for i in range(7)})
    assert len(drawn.figure.axes[1].lines) == 7
