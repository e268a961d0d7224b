"""Figures and tables of studies along axes, on numbers chosen by hand."""

import math
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from matplotlib.lines import Line2D

from mjforage.runs.studies.axes import Axis, Point
from mjforage.runs.studies.study import variant_folder
from mjforage.view.page.style import policy_colour
from mjforage.view.report.studies.along_axes import (
    reference_table,
    series_picture,
    tables_along,
)
from mjforage.view.report.studies.axis_figure import AxisFigure, axis_figure
from mjforage.view.report.studies.range_cost import Costs, cost_table
from mjforage.view.report.studies.study_logs import StudyLogs
from tests.mjforage.view.report.known_data import cells, known_study
from tests.mjforage.view.report.made_up_study import made_up_study, with_values, without

BOTH = ("greedy", "levy")
EPISODES = 12
NOISE = np.random.default_rng(3).normal(0.0, 1.0, EPISODES)
AXIS = Axis(
    "range",
    "range  [m]",
    "Range",
    {
        "open": (Point(16.0, "near"), Point(32.0, "far"), Point(math.inf)),
        "walls": (Point(16.0, "walled"),),
    },
    {math.inf: "any"},
)
PTA = {"complete": 90.0, "far": 90.0, "near": 40.0, "walled": 35.0}
NT90 = {"complete": 0.5, "far": 0.6, "near": 0.9, "walled": 1.0}


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> StudyLogs:
    """Make a study in which only Greedy played behind walls."""
    variants = dict.fromkeys(("complete", "near", "far"), BOTH) | {"walled": ("greedy",)}
    made = made_up_study(tmp_path_factory.mktemp("made") / "study", variants, EPISODES)
    values = {(n, "greedy", "pta_c"): mean + 0.1 * NOISE for n, mean in PTA.items()}
    values |= {(n, "greedy", "nt90"): mean + 0.001 * NOISE for n, mean in NT90.items()}
    values["far", "greedy", "pta_c"] = values["complete", "greedy", "pta_c"] + 0.1 * NOISE[::-1]
    return with_values(made, values)


def dots(lines: list[Line2D], policy: str) -> list[Line2D]:
    found = [line for line in lines if line.get_marker() not in ("None", "")]
    return [line for line in found if line.get_color() == policy_colour(policy)]


def test_means_stand_at_their_values_filled_where_they_differ(logs: StudyLogs) -> None:
    """Greedy at 16 m lies 50 points below the ideal link in every episode, at 32 m by chance."""
    drawn = axis_figure("axes", "T", "C.", AxisFigure(logs, "graph", (AXIS,), BOTH))
    panel, below = drawn.figure.axes
    found = [(float(np.ravel(d.get_xdata())[0]), d) for d in dots(list(panel.lines), "greedy")]
    means = [float(np.ravel(dot.get_ydata())[0]) for _, dot in found]
    assert means == pytest.approx([40, 90, 90, 35], abs=0.1)
    assert [round(x) for x, _ in found] == [0, 1, 2, 0]
    filled = [dot.get_markerfacecolor() == policy_colour("greedy") for _, dot in found]
    assert filled == [True, False, False, True]
    assert len(dots(list(panel.lines), "levy")) == 3, "it played no walls"
    assert len({round(x, 6) for x, _ in found}) == 4, "both lines stand at one place"
    assert [tick.get_text() for tick in below.get_xticklabels()] == ["16", "32", "any"]
    assert below.get_xlabel() == "range  [m]\nsolid: open\ndashed: walls"
    dashed = [line for line in panel.lines if line.get_linestyle() == "--"]
    assert {line.get_color() for line in dashed if np.size(line.get_xdata())} == {
        policy_colour("greedy")
    }


LEVELS = {"complete": 80.0, "near": 48.0, "far": 72.0}  # PTA_C of greedy in the graph
LOST = {("graph", "greedy"): 0.0, ("graph", "levy"): 8.0, ("hulls", "greedy"): 16.0}
LOST |= {("hulls", "levy"): 40.0}


@pytest.fixture(scope="module")
def two_worlds() -> StudyLogs:
    """What is lost in a world by a policy grows with what the variant costs: 80 less each."""
    variants = {
        name: {
            one: {"pta_c": pta - lost * (96.0 - pta) / 16.0, "nt90": (96.0 - pta + lost) / 128.0}
            for one, lost in LOST.items()
        }
        for name, pta in LEVELS.items()
    }
    return known_study(variants, "communication")


def test_every_world_and_policy_has_its_own_tables(two_worlds: StudyLogs) -> None:
    """Lost at complete, near and far: one, three and one and a half times the loss."""
    tables = tables_along(two_worlds, (AXIS,), ("pta_c", "nt90"), ("pta_c",))
    found = {table.name: cells(table) for table in tables}
    for (world, policy), lost in LOST.items():
        near, far = 32.0 + 2 * lost, 8.0 + 0.5 * lost
        differences = found[f"minus-{world}-{policy}"]
        assert differences["Range", "is near"] == (
            f"*−{near:.2f} (−{near:.2f} to −{near:.2f})*",
            "*0.250 (0.250 to 0.250)*",
        )
        assert differences["Range", "is far"][0] == f"*−{far:.2f} (−{far:.2f} to −{far:.2f})*"
        means = found[f"means-{world}-{policy}"]
        assert means["", "is complete"] == (f"{80 - lost:.2f} ± 1.96",)
        assert means["Range", "is near"] == (f"{48 - 3 * lost:.2f} ± 1.96".replace("-", "−"),)
    assert {table.name: table.better for table in tables}["minus-graph-levy"] == (1, -1)


def test_a_reference_is_that_of_the_same_world_and_policy(two_worlds: StudyLogs) -> None:
    axis = Axis("relay", "", "", {"": (Point(0.0, "near"), Point(1.0, "far"))}, against="near")
    found = cells(reference_table(two_worlds, axis, "relay", "Relay", ("pta_c",)))
    for (world, policy), lost in LOST.items():
        gain = f"{24 + 1.5 * lost:.2f}"
        assert found[f"{policy} · {world}", "is far"] == (f"*{gain} ({gain} to {gain})*",)


def test_figures_and_costs_of_a_world_are_of_that_world(two_worlds: StudyLogs) -> None:
    """From 16 to 32 m NT90 falls by 24/128 in both; PTA_C at 16 m is 48 less 3 times the loss."""
    drawn = axis_figure(
        "a", "T", "C.", AxisFigure(two_worlds, "hulls", (AXIS,), ("greedy", "levy"))
    )
    panel, below = drawn.figure.axes
    for policy, lost in (("greedy", 16.0), ("levy", 40.0)):
        means = [float(np.ravel(dot.get_ydata())[0]) for dot in dots(list(panel.lines), policy)]
        assert means == [48 - 3 * lost, 72 - 1.5 * lost, 80 - lost]
        times = [float(np.ravel(dot.get_ydata())[0]) for dot in dots(list(below.lines), policy)]
        assert times == [(48 + lost) / 128, (24 + lost) / 128, (16 + lost) / 128]
    (row, *_) = cost_table(Costs(two_worlds, AXIS, "hulls")).rows
    assert row.values[0] == pytest.approx((-24 / 128 / 0.016,) * 3)


def test_costs_of_information_are_of_their_world_and_step() -> None:
    """Greedy gains nothing from 16 to 32 m in hulls, levy a quarter: -15.625 per kilometre."""
    times = {("graph", "greedy"): (0.75, 0.5), ("graph", "levy"): (0.5, 0.5)}
    times |= {("hulls", "greedy"): (0.5, 0.5), ("hulls", "levy"): (0.75, 0.5)}
    variants = {
        name: {one: {"nt90": pair[place]} for one, pair in times.items()}
        for place, name in enumerate(("near", "far"))
    }
    logs = known_study({"complete": variants["far"], **variants}, "communication")
    for world, falls in (("graph", {"greedy"}), ("hulls", {"levy"})):
        costs = Costs(logs, AXIS, world)
        found = cells(cost_table(costs))
        for policy in ("greedy", "levy"):
            (cell,) = found["open", policy]
            assert cell.strip("*").startswith("−15.62" if policy in falls else "0.00")
            assert (cell[0] == "*") == (policy in falls)


def test_a_metric_without_any_difference_has_no_column(logs: StudyLogs) -> None:
    """As handover under the ideal link, where nothing is handed over."""
    holed = with_values(logs, {("complete", "greedy", "csr"): np.full(EPISODES, np.nan)})
    minus, means = tables_along(holed, (AXIS,), ("csr", "pta_c"), ("csr",))[:2]
    assert minus.columns == ("PTA_C",)
    assert len(minus.rows[0].cells) == len(minus.better) == len(minus.units) == 1
    assert means.columns == ("CSR",)


def measured(logs: StudyLogs, keys: tuple[str, ...]) -> list[str]:
    return [metric.key for metric in logs.measured(keys)]


def test_metrics_that_no_variant_has_are_left_out(logs: StudyLogs) -> None:
    assert measured(logs, ("pta_c", "handover", "nonsense")) == ["pta_c", "handover"]
    assert measured(without(logs, "handover"), ("pta_c", "handover")) == ["pta_c"]
    nowhere = {(n, who, "csr"): np.full(EPISODES, np.nan) for n in PTA for who in BOTH}
    del nowhere["walled", "levy", "csr"]  # it played no walls
    assert measured(with_values(logs, nowhere), ("pta_c", "csr")) == ["pta_c"]


def test_courses_are_a_line_per_variant_the_best_in_ink(logs: StudyLogs) -> None:
    variants = [("near", "16 m"), ("unplayed", "?"), ("far", "32 m"), ("complete", "ideal")]
    keys = ("aoi", "nonsense")
    drawn = series_picture(logs, ("ages", "T", "C."), variants, keys, "graph").figure
    for panel in drawn.axes[:2]:
        lines = [line for line in panel.lines if np.size(line.get_ydata())]
        assert len(lines) == 3
        assert (
            np.ravel(lines[0].get_ydata()).tolist() == [np.ravel(lines[0].get_ydata())[0]] * 13
        ), "as made up"
        assert len({str(line.get_color()) for line in lines}) == 3
    assert [text.get_text() for text in drawn.legends[0].get_texts()] == ["16 m", "32 m", "ideal"]
    assert [panel.get_title(loc="left") for panel in drawn.axes[:2]] == ["greedy", "levy"]
    assert "is not in this study" in drawn.axes[2].texts[0].get_text()


def test_bands_of_courses_lie_about_their_means(tmp_path: Path) -> None:
    """Ten episodes, five of 1 and five of 7: 4 ± 1.96 at every step."""
    made = made_up_study(tmp_path / "s", dict.fromkeys(("near", "complete"), ("greedy",)), 10)
    path = variant_folder(made.folder, "near") / "steps.parquet"
    value = pl.when(pl.col("episode") % 2 == 0).then(1.0).otherwise(7.0)
    pl.read_parquet(path).with_columns(aoi=value).write_parquet(path)
    variants = [("near", "16 m"), ("complete", "ideal")]
    drawn = series_picture(made, ("ages", "T", "C."), variants, ("aoi",), "graph")
    panel = drawn.figure.axes[0]
    band = np.asarray(panel.collections[0].get_paths()[0].vertices)
    assert (band[:, 1].min(), band[:, 1].max()) == pytest.approx((4 - 1.96, 4 + 1.96))
    line = np.asarray(panel.lines[0].get_xydata())
    assert line[:, 1].tolist() == [4.0] * 13
    assert (line[0, 0], line[-1, 0]) == (0.0, 1.0)
