import numpy as np
import pytest

from mjforage.base import row_cache
from mjforage.graph_planner.belief_planner import ways as w
from mjforage.graph_planner.belief_planner.ways import UNREACHED, Ways, row_to, ways_of
from mjforage.graph_planner.graph.navigation import NavigationGraph, navigation_graph
from mjforage.mission.moves import MoveRules
from tests.graph_planner.charts import grid


def by_hand(ways: Ways, start: int) -> dict[int, int]:
    """Decisions from a node to all others, forwards, breadth first."""
    found, front = {start: 0}, [start]
    while front:
        following = []
        for node in front:
            for end in ways.ends[node, :8].tolist():
                if end >= 0 and end not in found:
                    found[end] = found[node] + 1
                    following.append(end)
        front = following
    return found


@pytest.mark.parametrize(("moves", "shorten"), [(1, False), (2, False), (2, True), (3, True)])
def test_rows_are_the_fewest_decisions_forwards(
    ragged_coast: NavigationGraph, moves: int, shorten: bool
) -> None:
    ways = ways_of(ragged_coast, moves, MoveRules(True, shorten))
    for start in (0, 57, 200):
        reached = by_hand(ways, start)
        for target in range(0, len(ragged_coast), 7):
            found = int(ways.decisions[row_to(ways, target), start])
            assert found == reached.get(target, int(UNREACHED))


def test_strict_two_node_moves_leave_every_other_node_out() -> None:
    ways = ways_of(navigation_graph(grid("....."), 1.0, False), 2, MoveRules(True, False))
    assert ways.decisions[row_to(ways, 4), :].tolist() == [2, UNREACHED, 1, UNREACHED, 0]


def test_rows_that_made_room_for_others_come_back_the_same(
    ragged_coast: NavigationGraph, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = ways_of(ragged_coast, 1, MoveRules(True, True))
    monkeypatch.setattr(w, "TABLE_LIMIT", 10)
    monkeypatch.setattr(row_cache, "MEMORY", 0)
    monkeypatch.setattr(row_cache, "FEWEST_ROWS", 3)
    few = w.ways_of.__wrapped__(ragged_coast, 1, MoveRules(True, True))
    assert few.decisions.shape[0] == 3
    for target in (5, 9, 100, 5, 200, 9, 201, 5):
        np.testing.assert_array_equal(
            few.decisions[row_to(few, target)], whole.decisions[row_to(whole, target)]
        )
