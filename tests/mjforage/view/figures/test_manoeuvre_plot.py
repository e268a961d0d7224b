"""Plots of manoeuvres: what each panel shows, and the flows in the title."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.text import Text

from mjforage.physics.manoeuvre import Trajectory, manoeuvre
from mjforage.view.figures.manoeuvre_plot import manoeuvre_figure


def run(test: str, vessel: str = "otter", current: str = "0@0", wind: str = "0@0") -> Trajectory:
    return manoeuvre(vessel, test=test, current=current, wind=wind)


def words(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.findobj(Text)]


def test_panels_show_track_heading_speeds_and_commands() -> None:
    done = run("zigzag-20")
    figure = manoeuvre_figure(done)
    shown = [[np.asarray(line.get_xydata()) for line in axes.lines] for axes in figure.axes]
    wanted = [
        [done.states[:, :2], done.states[:1, :2]],
        [np.column_stack((done.times_s, np.degrees(done.states[:, 2])))],
        [np.column_stack((done.times_s, speed)) for speed in done.through_water.T],
        [np.column_stack((done.times_s, command)) for command in done.commands.T[::-1]],
    ]
    assert [len(lines) for lines in shown] == [len(lines) for lines in wanted]
    for lines, values in zip(shown, wanted, strict=True):
        for line, value in zip(lines, values, strict=True):
            np.testing.assert_allclose(line, value)


def test_the_title_names_flows_that_there_are() -> None:
    done = run("straight", vessel="forager", current="0.2@30", wind="5@-60")
    flows = "wind 5 m/s towards -60 deg, current 0.2 m/s towards 30 deg"
    assert f"{done.vessel.name}: straight, {flows}" in words(manoeuvre_figure(done))
    assert "otter: straight" in words(manoeuvre_figure(run("straight")))
