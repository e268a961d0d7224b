"""Ages, disagreement, contact, traffic and handover in missions, and by hand."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.exchange import LinkLog
from mjforage.mission.scan_log import ScanLog
from mjforage.mission.scoring import METRICS
from mjforage.mission.scoring.handover import first_received


def test_the_peak_of_the_age_is_that_after_maps_were_known_best() -> None:
    """Not the start, when all is unknown."""

    class Made:
        def series(self, metric: Any) -> NDArray[np.float64]:
            return np.array([[9.0, 5.0, 2.0, 4.0, 3.0], [9.0, 8.0, 7.0, 6.0, 6.0]])

    made: Any = Made()
    assert METRICS.find("aoi_peak")().value(made).tolist() == [4.0, 6.0]


# Handover by hand: a scout (0) and a forager (1); nodes 0, 1, 2 in a row, of which each agent sees
# its own alone. The forager receives what `received` says of the scout's scans, its own at once.

STEPS = 6


def link_of(at: Any, shown: Any, received: dict[int, int]) -> LinkLog:
    """Scans from nodes `at` (step, agent) that show so many items (step, agent)."""
    received_at = np.full((1, 2, 2, STEPS), -1, np.int16)
    for a in range(2):
        received_at[0, a, a] = np.arange(STEPS)
    for step, arrival in received.items():
        received_at[0, 1, 0, step] = arrival
    each: Any = {name: np.zeros((1, STEPS, 2)) for name in ScanLog._fields}
    each |= {
        "node": np.array([at], np.int32),
        "shown": np.array(shown, np.int16)[None, :, :, None],
        "occupied": np.array([shown], np.int32),
    }
    views = NodeLists(np.arange(4)[None], np.arange(3, dtype=np.int32))
    none = np.zeros(1, np.int64)
    return LinkLog(
        contact=np.zeros((1, 2, 2), np.bool_),
        delivered=none,
        lost=none,
        lost_now=np.zeros((1, 2, 2), np.int64),
        dropped=none,
        bytes=none,
        received_at=received_at,
        scans=ScanLog(**each),
        views=views,
        radius_number=np.zeros(2, np.int64),
    )


SCOUT_STAYS = [[0, 2]] * STEPS  # and the forager, far off
SEES_ONE = [[1, 0]] * STEPS


@pytest.mark.parametrize(
    ("received", "found", "expected"),
    [
        ({}, 1, -1),  # nobody who collects ever receives
        ({1: 1}, 1, 1),  # at once
        ({1: 4}, 1, 4),  # delayed
        ({1: 5, 2: 3}, 1, 3),  # a scan made later comes first
        ({0: 2}, 1, -1),  # made before the discovery, it cannot have shown it
        ({1: 9}, 1, -1),  # arrives after the end
        ({4: 4, 1: 4}, 1, 4),
    ],
)
def test_first_reception_of_an_item(received: dict[int, int], found: int, expected: int) -> None:
    link = link_of(SCOUT_STAYS, SEES_ONE, received)
    item_node = np.zeros((1, STEPS, 1), np.int32)
    about = item_node, np.array([[found]], np.int16), np.array([STEPS - 1], np.int32)
    assert first_received(link, np.array([1]), *about).tolist() == [[expected]]
