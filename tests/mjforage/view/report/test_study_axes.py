"""Figures and tables of studies along axes, on numbers chosen by hand."""

import math

import numpy as np
import pytest
from matplotlib.lines import Line2D

from mjforage.runs.studies.axes import Axis, Point
from mjforage.view.page.style import policy_colour
from mjforage.view.report.studies.along_axes import reference_table, tables_along
from mjforage.view.report.studies.axis_figure import axis_figures
from mjforage.view.report.studies.study_logs import StudyLogs
from tests.mjforage.view.report.known_data import cells, known_study, told
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
    {"inf": "any"},
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
    (drawn,) = axis_figures(logs, ("axes", "T", "C."), (AXIS,), BOTH)
    panel, below = drawn.figure.axes
    found = [(float(np.ravel(d.get_xdata())[0]), d) for d in dots(list(panel.lines), "greedy")]
    means = [float(np.ravel(dot.get_ydata())[0]) for _, dot in found]
    assert means == pytest.approx([40, 90, 90, 35], abs=0.1)
    assert [round(x) for x, _ in found] == [0, 1, 2, 0], "both lines stand at one place"
    filled = [dot.get_markerfacecolor() == policy_colour("greedy") for _, dot in found]
    assert filled == [True, False, False, True]
    assert len(dots(list(panel.lines), "levy")) == 3, "it played no walls"
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
        assert means["", "is complete"] == (told("pta_c", 80.0 - lost),)
        assert means["Range", "is near"] == (told("pta_c", 48.0 - 3 * lost),)
    assert {table.name: table.better for table in tables}["minus-graph-levy"] == (1, -1)


def test_a_reference_is_that_of_the_same_world_and_policy(two_worlds: StudyLogs) -> None:
    axis = Axis("relay", "", "", {"": (Point(0.0, "near"), Point(1.0, "far"))}, against="near")
    found = cells(reference_table(two_worlds, axis, "relay", "Relay", ("pta_c",)))
    for (world, policy), lost in LOST.items():
        gain = f"{24 + 1.5 * lost:.2f}"
        assert found[f"{policy} · {world}", "is far"] == (f"*{gain} ({gain} to {gain})*",)


def test_figures_of_a_world_are_of_that_world(two_worlds: StudyLogs) -> None:
    """PTA_C at 16 m is 48 less 3 times the loss."""
    _, drawn = axis_figures(two_worlds, ("a", "T", "C."), (AXIS,), BOTH)
    panel, below = drawn.figure.axes
    for policy, lost in (("greedy", 16.0), ("levy", 40.0)):
        means = [float(np.ravel(dot.get_ydata())[0]) for dot in dots(list(panel.lines), policy)]
        assert means == [48 - 3 * lost, 72 - 1.5 * lost, 80 - lost]
        times = [float(np.ravel(dot.get_ydata())[0]) for dot in dots(list(below.lines), policy)]
        assert times == [(48 + lost) / 128, (24 + lost) / 128, (16 + lost) / 128]


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
