"""Plots of manoeuvres: axes by what happens, headings without jumps, key figures in the plot."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch
from matplotlib.text import Text
from numpy.typing import NDArray

from mjforage.physics.manoeuvre import STANDARD_TESTS, Trajectory, key_figures, manoeuvre
from mjforage.physics.manoeuvre.standard import APPROACH_S
from mjforage.view.figures.manoeuvre_plot import (
    HULLS,
    hull_rows,
    manoeuvre_figure,
    shown_value,
    wrapped,
)


def run(test: str, vessel: str = "otter", current: str = "0@0", wind: str = "0@0") -> Trajectory:
    return manoeuvre(vessel, test=test, current=current, wind=wind)


def largest(figure: Figure) -> Axes:
    """The panel that takes most of the figure, of those with axes."""
    figure.canvas.draw()
    panels = [axes for axes in figure.axes if axes.axison]
    return max(panels, key=lambda axes: axes.get_window_extent().width * axes.bbox.height)


def words(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.findobj(Text)]


def xy(line: object) -> NDArray[np.float64]:
    return np.asarray(line.get_xydata())  # type: ignore[attr-defined]


@pytest.fixture(scope="module")
def circle() -> Trajectory:
    return run("turning-circle")


@pytest.fixture(scope="module")
def zigzag() -> Trajectory:
    return run("zigzag-20")


def test_a_turning_circle_is_its_track_with_the_diameter(
    circle: Trajectory, tmp_path: Path
) -> None:
    figure = manoeuvre_figure(circle)
    track = largest(figure)
    np.testing.assert_array_equal(xy(track.lines[0]), circle.states[:, :2])
    diameter = key_figures(circle)["turning_diameter"].value
    assert f"diameter {diameter:.3g} m" in words(figure)
    arrow = next(one for one in track.texts if getattr(one, "arrow_patch", None))
    left, right = sorted((arrow.xy[0], arrow.get_position()[0]))  # type: ignore[attr-defined]
    assert right - left == pytest.approx(diameter)
    assert left == pytest.approx(circle.states[:, 0].min(), abs=0.05 * diameter)
    figure.savefig(tmp_path / "way.png")
    assert (tmp_path / "way.png").stat().st_size > 10_000


def test_a_turn_that_drifts_has_its_diameter_in_the_water() -> None:
    done = run("turning-circle", vessel="scout", current="0.3@90")
    diameter = key_figures(done)["turning_diameter"].value
    figure = manoeuvre_figure(done)
    assert f"diameter {diameter:.3g} m in the water" in words(figure)
    circles = [one for one in largest(figure).patches if isinstance(one, Circle)]
    assert [2.0 * one.get_radius() for one in circles] == [pytest.approx(diameter)]
    assert not [one for one in largest(figure).texts if getattr(one, "arrow_patch", None)]


def test_hulls_along_a_track_lie_apart_and_show_its_ends() -> None:
    turns = np.linspace(0.0, 9.0 * np.pi, 2000)
    circle = 10.0 * np.column_stack((np.cos(turns), np.sin(turns)))
    for places in (circle, np.column_stack((turns, 0.0 * turns)), np.zeros((50, 2))):
        rows = hull_rows(places, 2.0)
        drawn = places[rows]
        between = np.linalg.norm(drawn[:, None] - drawn[None], axis=2)
        assert (between[np.triu_indices(len(rows), 1)] > 2.0).all()
        assert len(rows) <= HULLS
        for end in places[[0, -1]]:
            assert np.linalg.norm(drawn - end, axis=1).min() < 1e-9
    assert len(hull_rows(circle, 2.0)) > HULLS // 2, "all around"


def test_a_zigzag_is_heading_and_helm_over_time(zigzag: Trajectory) -> None:
    figure = manoeuvre_figure(zigzag)
    shown = largest(figure)
    pairs = [axes for axes in figure.axes if axes.bbox.bounds == shown.bbox.bounds]
    lines = [xy(axes.lines[0]) for axes in pairs]
    start = np.interp(APPROACH_S, zigzag.times_s, zigzag.states[:, 2])
    wanted = [
        np.degrees(zigzag.states[:, 2] - start),
        zigzag.commands[:, 1] - zigzag.commands[:, 0],
    ]
    for values in wanted:
        assert any(
            line.shape[0] == values.size and np.allclose(line[:, 1], values) for line in lines
        )
    first = key_figures(zigzag)["overshoot_1"].value
    assert f"+{first:.1f}°" in words(figure)


@pytest.mark.parametrize("test", ["straight", "stop"])
def test_a_run_ahead_is_speed_over_time(test: str) -> None:
    done = run(test)
    line = xy(largest(manoeuvre_figure(done)).lines[0])
    np.testing.assert_array_equal(line[:, 0], done.times_s)
    np.testing.assert_allclose(line[:, 1], done.through_water[:, 0])


@pytest.mark.parametrize("test", STANDARD_TESTS)
def test_every_test_shows_its_key_figures_and_the_flows(test: str) -> None:
    done = run(test, vessel="forager", current="0.2@30", wind="5@-60")
    said = words(manoeuvre_figure(done))
    for name, figure in key_figures(done).items():
        assert name.replace("_", " ") in said
        assert f"{shown_value(figure.value)} {figure.unit}" in said
    assert "wind\n5 m/s" in said
    assert "current\n0.2 m/s" in said


def test_arrows_go_the_way_the_flows_go_and_hulls_point_ahead() -> None:
    figure = manoeuvre_figure(run("straight", vessel="scout", current="0.2@90", wind="3@180"))
    ends = (
        np.asarray(arrow._posA_posB)  # type: ignore[attr-defined]
        for arrow in figure.findobj(FancyArrowPatch)
        if arrow.get_mutation_scale() == 14.0
    )
    wind, current = (end - start for start, end in ends)
    assert wind[0] < 0.0 and wind[1] == pytest.approx(0.0, abs=1e-9)
    assert current[1] > 0.0 and current[0] == pytest.approx(0.0, abs=1e-9)
    north = manoeuvre("scout", test="straight", heading_deg=90.0)
    track = next(axes for axes in manoeuvre_figure(north).axes if axes.patches)
    first = np.asarray(track.patches[0].get_path().vertices)
    x, y = north.states[0, :2]
    assert first[first[:, 1].argmax()] - (x, y) == pytest.approx((0.0, np.ptp(first[:, 1]) / 2))
    across = north.vessel.beam_m / north.vessel.length_m
    assert np.ptp(first[:, 0]) / np.ptp(first[:, 1]) == pytest.approx(across)


def test_without_wind_and_current_there_is_no_arrow(circle: Trajectory) -> None:
    assert not [
        text for text in words(manoeuvre_figure(circle)) if text.startswith(("wind", "curr"))
    ]


def test_headings_are_wrapped_without_lines_across() -> None:
    """Two turns to port: from 0 to 180, then from -180 on."""
    degrees = wrapped(np.radians(np.arange(0.0, 720.0, 5.0)))
    assert np.nanmin(degrees) >= -180.0 and np.nanmax(degrees) <= 180.0
    steps = np.diff(degrees)
    assert np.nanmax(np.abs(steps)) < 10.0, "no line from one end to the other"
    assert np.isnan(degrees).sum() == 2
    np.testing.assert_allclose(degrees[20:30], np.arange(100.0, 150.0, 5.0))
