"""Pages of the studies of links and of sensing, in two worlds whose means are known."""

import numpy as np
import pytest
from matplotlib.axes import Axes

from mjforage.view.page.figure import ReportFigure
from mjforage.view.page.style import policy_colour
from mjforage.view.report.studies import communication, sensing
from mjforage.view.report.studies.study_logs import StudyLogs
from tests.mjforage.view.report.known_data import Means, cells, known_study

LOST = {
    ("graph", "belief"): 0.0,
    ("graph", "greedy"): 8.0,
    ("hulls", "belief"): 16.0,
    ("hulls", "greedy"): 40.0,
}

SHARE = {"graph": 128.0, "hulls": 256.0}


def means(pta_c: float) -> Means:
    """What hulls and greedy lose doubles where there is less than 80 without them."""
    factor = 1.0 if pta_c >= 80.0 else 2.0
    return {
        one: {"pta_c": pta_c - factor * lost, "nt90": (96.0 - pta_c) / SHARE[one[0]]}
        for one, lost in LOST.items()
    }


@pytest.fixture(scope="module")
def links() -> StudyLogs:
    pta = {"complete": 80.0, "none": 48.0, "range-16": 64.0, "relay-nobody": 40.0}
    pta |= {"relay-low": 56.0, "relay-mast": 60.0, "relay-all": 72.0}
    return known_study({name: means(mean) for name, mean in pta.items()}, "communication")


@pytest.fixture(scope="module")
def looks() -> StudyLogs:
    pta = {"complete": 80.0, "detection-0.5": 64.0, "detection-0.5-for-1": 56.0}
    return known_study({name: means(mean) for name, mean in pta.items()}, "sensing")


def heights(axes: Axes, policy: str) -> list[float]:
    """At which values a policy's markers stand, from left to right."""
    found = [line for line in axes.lines if line.get_marker() not in ("None", "")]
    own = [line for line in found if line.get_color() == policy_colour(policy)]
    places = [(float(np.ravel(x.get_xdata())[0]), float(np.ravel(x.get_ydata())[0])) for x in own]
    return [y for _, y in sorted(places)]


def panel(pictures: list[ReportFigure], name: str, place: int = 0) -> Axes:
    (found,) = [one for one in pictures if one.name == name]
    return found.figure.axes[place]


def test_performance_over_a_link_is_of_its_world(links: StudyLogs) -> None:
    section = communication._performance(links)
    found = {table.name: cells(table) for table in section.tables}
    assert set(found) == {f"{kind}-{w}-{p}" for kind in ("minus", "means") for w, p in LOST}
    for (world, policy), lost in LOST.items():
        fall = f"−{32 + lost:.2f}"
        (row,) = [
            one for (_, head), one in found[f"minus-{world}-{policy}"].items() if "none" in head
        ]
        assert row[0].strip("*") == f"{fall} ({fall} to {fall})"
        low, high = 48 - 2 * lost, 64 - 2 * lost
        drawn = heights(panel(list(section.pictures), f"axes-{world}"), policy)
        assert drawn[:3] == [low, low, high], "no link, on both lines, and 16 m"


def test_a_relay_is_worth_what_it_adds_to_nobody(links: StudyLogs) -> None:
    """Nobody 40, the boat 56, its mast 60, all 72; each loses as much as nobody does."""
    (table,) = communication._relay(links).tables
    found = cells(table)
    assert len(found) == 3 * len(LOST)
    for world, policy in LOST:
        gains = [
            found[f"{policy} · {world}", f"is relay-{one}"][0] for one in ("low", "mast", "all")
        ]
        assert [gain.strip("*").split()[0] for gain in gains] == ["16.00", "20.00", "32.00"]


def test_what_is_sensed_and_what_is_assumed_are_drawn_world_by_world(looks: StudyLogs) -> None:
    """Half of the looks miss: 64, and 56 where the planner takes that for none."""
    performance, assumed = sensing._performance(looks), sensing._assumed(looks)
    for world in ("graph", "hulls"):
        for policy in ("belief", "greedy"):
            lost = LOST[world, policy]
            drawn = heights(panel(list(performance.pictures), f"axes-{world}"), policy)
            assert drawn == [64 - 2 * lost, 80 - lost, 80 - lost]
        lost = LOST[world, "belief"]
        wrong = panel(list(assumed.pictures), f"assumed-{world}")
        assert sorted(heights(wrong, "belief")[:2]) == [56 - 2 * lost, 64 - 2 * lost]
        assert heights(wrong, "greedy") == [], "it assumes nothing"
