"""What a plain function sees of an episode, on a map where all of it is known."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import mjforage as mf

WALL = np.ones((5, 7), bool)
WALL[1:, 3] = False  # the way from west to east leads round by the north
STARTS = ((4, 0), (4, 1))


@pytest.fixture(scope="module")
def harbour() -> mf.Scenario:
    """A wall between two basins; one scout and one forager in the west."""
    water = mf.Map(WALL, pitch_m=2.0, starts=STARTS)
    team = {"scouts": {"count": 1, "radius": 9.0}, "foragers": {"count": 1}}
    items = {"mean": 3, "std": 0}
    return mf.load_scenario("open-bay", map=water, horizon=6, team=team, items=items)


def seen(scenario: mf.Scenario, look: Callable[[mf.View], Any]) -> list[Any]:
    """What a function finds in each view of episode 0."""
    found: list[Any] = []
    mission = mf.make_mission(scenario)
    mission.reset(seed=3)
    list(mission.play({"looking": lambda view: found.append(look(view))}))
    return found


def test_names_and_places(harbour: mf.Scenario) -> None:
    [first, *_] = seen(harbour, lambda view: (view.agents, view.scouts, view.collectors, view.step))
    assert first == (("scouts_0", "foragers_0"), ("scouts_0",), ("foragers_0",), 1)
    cells = seen(harbour, lambda view: {view.cell(agent) for agent in view.agents})[0]
    assert cells == set(STARTS)
    x_m, y_m = seen(harbour, lambda view: view.xy_m((4, 1)))[0]
    assert (x_m, y_m) == (2.0, 0.0)  # a column east of the south-west corner


def test_distances_go_by_water(harbour: mf.Scenario) -> None:
    about = seen(harbour, lambda v: (v.distance((1, 2), (1, 4)), v.distance((0, 2), (0, 4))))[0]
    assert about == pytest.approx((4.0, 2.0))  # no corner is cut: up, two east, down
    assert about[0] == 4.0


def test_toward_ends_nearest_by_water(harbour: mf.Scenario) -> None:
    moves = seen(harbour, lambda view: view.toward("foragers_0", (4, 4)))
    assert moves[0] in ("N", "NE")
    assert seen(harbour, lambda view: view.toward("foragers_0", "foragers_0"))[0] == "stay"


def test_of_equal_moves_toward_takes_the_first(bay: mf.Scenario) -> None:
    """A scout moves two nodes: east passes the node beside it and ends as near as staying does."""

    def beside(view: mf.View) -> str:
        row, column = view.cell("scouts_0")
        return view.toward("scouts_0", (row, column + 1))

    assert seen(bay, beside)[0] == "E"


def test_legal_moves_end_in_water(harbour: mf.Scenario) -> None:
    def ends(view: mf.View) -> bool:
        places = [view.cell(view.end_of("foragers_0", m)) for m in view.legal_moves("foragers_0")]
        return all(WALL[place] for place in places)

    assert all(seen(harbour, ends))


def test_known_items_and_ages(harbour: mf.Scenario) -> None:
    counts = seen(harbour, lambda view: (sum(view.items.values()), int(view.belief.sum())))
    assert all(total == laid for total, laid in counts)
    ages = seen(harbour, lambda view: view.age.copy())
    assert ages[0][STARTS[0]] == 0.0 and np.isinf(ages[0]).any()


def test_the_generator_is_of_episode_and_decision(harbour: mf.Scenario) -> None:
    first, again = (seen(harbour, lambda view: view.rng.random()) for _ in range(2))
    assert first == again and len(set(first)) == len(first)


def test_one_generator_serves_all_draws_of_a_decision(harbour: mf.Scenario) -> None:
    pairs = seen(harbour, lambda view: (view.rng.random(), view.rng.random()))
    assert all(one != other for one, other in pairs)


def test_each_owner_sees_and_draws_its_own() -> None:
    apart = mf.load_scenario("open-bay", horizon=4, link={"model": "none"})
    draws = seen(apart, lambda view: (view.step, view.rng.random()))
    assert len(draws) == len(set(draws)) == 4 * len(apart.fleet)


@pytest.mark.parametrize(
    ("look", "words"),
    [
        (lambda v: v.node("scout_0"), "agent 'scout_0': unknown; did you mean scouts_0?"),
        (lambda v: v.toward("foragers_0", (1, 3)), r"node \(1, 3\): is no water of this map"),
        (lambda v: v.toward("foragers_0", 99), "node 99: is no water of this map"),
        (lambda v: v.end_of("foragers_0", "S"), "move 'S' of foragers_0: is not legal here"),
    ],
)
def test_refusals(harbour: mf.Scenario, look: Callable[[mf.View], Any], words: str) -> None:
    with pytest.raises(mf.UserError, match=f"policy looking: {words}"):
        seen(harbour, look)


def test_the_map_cannot_be_written(harbour: mf.Scenario) -> None:
    def write(view: mf.View) -> None:
        view.water[0, 0] = False

    with pytest.raises(mf.UserError, match="policy looking: raised ValueError: assignment"):
        seen(harbour, write)
