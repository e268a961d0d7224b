"""Plots of manoeuvres: what each panel shows, headings without jumps, key figures in the plot."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from mjforage.physics.manoeuvre import STANDARD_TESTS, Trajectory, key_figures, manoeuvre
from mjforage.view.figures.manoeuvre_plot import VESSELS, manoeuvre_figure, shown_value, wrapped


def run(test: str, vessel: str = "otter", current: str = "0@0", wind: str = "0@0") -> Trajectory:
    return manoeuvre(vessel, test=test, current=current, wind=wind)


def words(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.findobj(Text)]


def test_panels_show_track_heading_speeds_and_commands() -> None:
    done = run("zigzag-20")
    figure = manoeuvre_figure(done)
    shown = [[np.asarray(line.get_xydata()) for line in axes.lines] for axes in figure.axes]
    wanted = [
        [done.states[:, :2]],
        [np.column_stack((done.times_s, np.degrees(done.states[:, 2])))],
        [np.column_stack((done.times_s, speed)) for speed in done.through_water.T],
        [np.column_stack((done.times_s, command)) for command in done.commands.T],
        [],
    ]
    assert [len(lines) for lines in shown] == [len(lines) for lines in wanted]
    for lines, values in zip(shown, wanted, strict=True):
        for line, value in zip(lines, values, strict=True):
            np.testing.assert_allclose(line, value)


@pytest.mark.parametrize("test", STANDARD_TESTS)
def test_every_test_has_its_key_figures_and_the_flows(test: str) -> None:
    done = run(test, vessel="forager", current="0.2@30", wind="5@-60")
    found = words(manoeuvre_figure(done))
    for name, figure in key_figures(done).items():
        assert f"{name.replace('_', ' ')}\n{shown_value(figure.value)} {figure.unit}" in found
    flows = "wind 5 m/s towards -60 deg, current 0.2 m/s towards 30 deg"
    assert f"{done.vessel.name}: {test}, {flows}" in found


def test_still_air_and_water_are_not_named() -> None:
    assert "otter: straight" in words(manoeuvre_figure(run("straight")))


def test_vessels_on_the_track_point_ahead_and_have_their_shape() -> None:
    north = manoeuvre("scout", test="straight", heading_deg=90.0)
    track = manoeuvre_figure(north).axes[0]
    assert len(track.patches) == VESSELS
    first = np.asarray(track.patches[0].get_path().vertices)
    x, y = north.states[0, :2]
    assert first[first[:, 1].argmax()] - (x, y) == pytest.approx((0.0, np.ptp(first[:, 1]) / 2))
    across = north.vessel.beam_m / north.vessel.length_m
    assert np.ptp(first[:, 0]) / np.ptp(first[:, 1]) == pytest.approx(across)


def test_headings_are_wrapped_without_lines_across() -> None:
    """Two turns to port: from 0 to 180, then from -180 on."""
    degrees = wrapped(np.radians(np.arange(0.0, 720.0, 5.0)))
    assert np.nanmin(degrees) >= -180.0 and np.nanmax(degrees) <= 180.0
    steps = np.diff(degrees)
    assert np.nanmax(np.abs(steps)) < 10.0, "no line from one end to the other"
    assert np.isnan(degrees).sum() == 2
    np.testing.assert_allclose(degrees[20:30], np.arange(100.0, 150.0, 5.0))
