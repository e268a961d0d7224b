"""The maps of two holders: which two, what is drawn of them, and what is said."""

from dataclasses import replace

import numpy as np
import pytest

from mjforage.runs.episode_recording import Recording
from mjforage.runs.holders_seen import UNSEEN, HoldersMaps
from mjforage.view.report.studies.holder_maps import holders_picture, pair_of
from tests.mjforage.view.report.made_up_episodes import Plan, made_up_episode

STEP = 4


@pytest.fixture(scope="module")
def replay() -> Recording:
    return made_up_episode(Plan(), "graph", "greedy", 0, 1.0).replay


@pytest.fixture
def maps(replay: Recording) -> HoldersMaps:
    """Return what four holders know: all but forager 1 of nothing, and of itself alone."""
    shape, agents = replay.navigable.shape, 4
    belief = np.zeros((agents, *shape), np.int16)
    belief[3, 2, 2] = 5
    age = np.full((agents, *shape), UNSEEN, np.int32)
    age[3, 2, 1:4] = [0, 2, 4]
    places = np.tile(replay.agent_rc[STEP].astype(np.int64), (agents, 1, 1))
    places[3, 0] = replay.agent_rc[0, 0] + [0, 9]  # scout 0 was there, it has heard
    names = ("scouts_0", "scouts_1", "foragers_0", "foragers_1")
    ages = np.zeros((agents, agents), np.int64)
    return HoldersMaps(STEP, names, np.arange(agents), belief, age, places, ages)


def test_the_scout_and_the_forager_least_alike_are_shown(maps: HoldersMaps) -> None:
    collects = np.array([False, False, True, True])
    assert pair_of(maps, collects) == (0, 3)
    other = maps.belief.copy()
    other[1, 5, 5] = 1
    assert pair_of(replace(maps, belief=other), collects) == (1, 3)
    assert pair_of(maps, ~np.zeros(4, np.bool_)) == (0, 3)
    assert pair_of(maps, np.zeros(4, np.bool_)) == (0, 3)


def test_what_each_knows_is_drawn_and_counted(replay: Recording, maps: HoldersMaps) -> None:
    drawn = holders_picture("holders", "T", replay, maps)
    panels = drawn.figure.axes[:4]
    titles = [panel.get_title(loc="left") for panel in panels]
    assert titles == [
        "(a) scouts_0 believes",
        "(b) foragers_1 believes",
        "(c) scouts_0: age",
        "(d) foragers_1: age",
    ]
    images = [panel.images[0].get_array() for panel in panels]
    assert [int(np.asarray(image).max()) for image in images[:2]] == [0, 5]
    water = int(replay.navigable.sum())
    assert "scouts_0 believes in 0 items and has heard of no look at 100 %" in drawn.caption
    share = f"{100 * (water - 3) / water:.0f} %"
    assert f"foragers_1 believes in 5 items and has heard of no look at {share}" in drawn.caption
    assert f"{int(replay.item_present[STEP].sum())} items are afloat" in drawn.caption


def test_who_is_lost_has_a_line_to_where_it_is(replay: Recording, maps: HoldersMaps) -> None:
    found, lost = holders_picture("holders", "T", replay, maps).figure.axes[:2]
    threads = [
        [line for line in panel.lines if np.size(line.get_xdata()) == 2] for panel in (found, lost)
    ]
    assert [len(each) for each in threads] == [0, 1]
    (thread,) = threads[1]
    ends = np.asarray(thread.get_xydata())[:, ::-1]
    assert ends[0].tolist() == maps.agent_rc[3, 0].tolist()
    assert ends[1].tolist() == replay.agent_rc[STEP, 0].tolist()
