import numpy as np
import pytest

from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.dynamics import Transition, start_state
from mjforage.mission.initial_state import InitialState
from mjforage.mission.task import IDLE, MISSED, TAKEN, UNREACHABLE
from mjforage.physics.dynamics.collecting import (
    ATTEMPTS,
    LATER_S,
    Attempts,
    Goal,
    Reach,
    Sent,
    collect_at_mouth,
    mouths_of,
    seek,
)
from mjforage.physics.dynamics.tracks import LandGrid
from mjforage.scenario.scenario import Physics

ON = np.ones(1, np.bool_)
GRAPH = navigation_graph(np.array([[1, 1, 1], [1, 0, 1]], np.bool_), 4.0, False)
OPEN = LandGrid(np.zeros((0, 0), np.bool_), 4.0)
REACH = Reach(np.array([False, True]), np.array([[0.7, 0.5], [1.0, 0.54]]), OPEN, narrow=True)
CENTRES = np.stack((GRAPH.rows, GRAPH.cols), axis=1).astype(np.float64)


def state_of(item_node: list[int]) -> Transition:
    nodes = np.array([item_node], np.int32)
    rc = np.where(nodes[..., None] >= 0, CENTRES[nodes], 0.0)
    count = np.array([sum(n >= 0 for n in item_node)], np.int32)
    world = InitialState(count, rc, nodes, np.zeros((1, 2)), np.array([[0, 2]], np.int32))
    return start_state(world, CENTRES)


def sent_to_the_origin(stay: bool = False) -> Sent:
    return Sent(np.zeros((1, 2, 2)), np.full((1, 2), stay))


def test_the_mouth_is_the_beam_wide_at_the_bow_and_fills_up() -> None:
    """A forager at the origin heads north: bow at y = 1, beam from x = -0.54 to 0.54."""
    places = [(0.0, 1.1), (0.53, 0.95), (0.55, 1.0), (0.0, 1.2), (0.0, 0.6), (-0.5, 1.0)]
    state = state_of([3] * 6)
    xy = np.array([places])
    pose = np.array([[[50.0, 50.0, 0.0], [0.0, 0.0, np.pi / 2]]])
    room = np.array([[5, 2]])
    at_once, now = mouths_of(Physics(), 2, 0.1).of(1), np.zeros(1)
    taken = collect_at_mouth(REACH, ON, pose, xy, room, state, at_once, now)
    assert taken == 2 and state.pickup.tolist() == [[IDLE, TAKEN]]
    assert room.tolist() == [[5, 0]]
    assert state.collected_by.tolist() == [[1, 1, -1, -1, -1, -1]]
    assert state.item_node.tolist() == [[-1, -1, 3, 3, 3, 3]]
    room[:] = 5
    assert collect_at_mouth(REACH, ON, pose, xy, room, state, at_once, now) == 1
    assert state.collected_by[0].tolist() == [1, 1, -1, -1, -1, 1]


def swallowed(physics: Physics, items: list[int], seconds: float = 40.0) -> list[float]:
    """Times at which a mouth takes items, of which so many lie in it from tick 10 i on.

    Called every 0.1 s, by the clock that missions have.
    """
    mouths, state = mouths_of(physics, 2, 0.1).of(1), state_of([3] * sum(items))
    xy, pose = np.full((1, sum(items), 2), 90.0), np.zeros((1, 2, 3))
    pose[0, 0] = 50.0
    times: list[float] = []
    for tick in range(round(seconds / 0.1)):
        if tick % 10 == 0:
            xy[0, : sum(items[: tick // 10 + 1])] = 1.0, 0.1
        now = np.array([tick], np.int64) * np.float64(0.1)
        room = np.array([[0, 99]])
        taken = collect_at_mouth(REACH, ON, pose, xy, room, state, mouths, now)
        times += [round(float(now[0]), 6)] * taken
    return times


@pytest.mark.parametrize("rate", [0.5, 1.0, 3.0, 7.0, 10.0, 25.0])
def test_a_mouth_takes_so_many_items_in_a_second(rate: float) -> None:
    """At the first tick at or after n / rate, whether rate and ticks fit or not."""
    times = swallowed(Physics(intake_rate_per_s=rate), [20])
    expected = [np.ceil(n / rate / 0.1 - 1e-6) * 0.1 for n in range(20)]
    np.testing.assert_allclose(times, expected, atol=1e-6)


def test_an_idle_mouth_saves_nothing_up() -> None:
    """Three items after 5 s of nothing are taken one by one too, as those before them were."""
    times = swallowed(Physics(intake_rate_per_s=2.0), [3, 0, 0, 0, 0, 0, 3])
    np.testing.assert_allclose(times, [0.0, 0.5, 1.0, 6.0, 6.5, 7.0], atol=1e-6)


def test_a_mouth_jams_when_too_many_wait() -> None:
    """Of seven, it jams with four and more that wait: after the first, second and third one."""
    jams = Physics(intake_rate_per_s=1.0, intake_jam_items=4, intake_jam_s=6.0)
    np.testing.assert_allclose(swallowed(jams, [7]), [0, 6, 12, 18, 19, 20, 21], atol=1e-6)
    np.testing.assert_allclose(swallowed(jams, [4]), [0, 1, 2, 3], atol=1e-6)
    without_rate = Physics(intake_jam_items=4, intake_jam_s=6.0)
    assert swallowed(without_rate, [7]) == [0.0] * 7


def test_the_goal_is_the_nearest_item_within_the_target_node() -> None:
    """Even if one beside the node is nearer to the bow."""
    state = state_of([0, 0, -1, 0])
    xy = np.array([[[[1.9, -1.9], [-1.0, 0.0], [0.1, 0.0], [2.1, 0.0]]] * 2])
    pose = np.array([[[1.0, 0.0, 0.0]] * 2])
    sent, goal, room = sent_to_the_origin(), Goal.of(1, 2), np.array([[1, 1]])
    attempts, now = Attempts.of(2, state.item_node), np.zeros(1)
    seek(REACH, attempts, ON, room, pose, xy, sent, now, state, goal)
    assert np.isnan(goal.xy[0, 0]).all()
    assert goal.xy[0, 1].tolist() == [-1.0, 0.0]
    assert state.pickup.tolist() == [[IDLE, MISSED]]
    seek(REACH, attempts, ON, np.array([[1, 0]]), pose, xy, sent, now, state, goal)
    assert np.isnan(goal.xy).all() and np.isnan(goal.next).all() and not goal.look.any()


def sought(
    x: float,
    y: float,
    stay: bool = False,
    reach: Reach = REACH,
    at: tuple[float, float] = (0.0, 0.0),
    later_s: float = 0.0,
) -> tuple[list[float], list[float], bool, int]:
    """What a forager does about one item, in its node or not: pick up, be ready, look."""
    state, goal = state_of([0]), Goal.of(1, 2)
    attempts, now, room = Attempts.of(2, state.item_node), np.zeros(1), np.ones((1, 2), np.int64)
    attempts.later_s[:] = later_s
    xy, pose = np.array([[[[x, y]]] * 2]), np.array([[[*at, 0.0]] * 2])
    sent = sent_to_the_origin(stay)
    seek(reach, attempts, ON, room, pose, xy, sent, now, state, goal)
    pickup = int(state.pickup[0, 1])
    return goal.xy[0, 1].tolist(), goal.next[0, 1].tolist(), bool(goal.look[0, 1]), pickup


def test_an_item_beside_the_node_is_picked_up_if_midships_need_not_leave_it() -> None:
    """Bow and item are 1.1 m long, midships may go 1.68 m from the middle: 2.78 m in all.

    Across a corner of the node there may be land, and an item outside is no failure of the node.
    """
    assert sought(2.77, 0.0)[0] == [2.77, 0.0]
    assert sought(0.0, -2.77)[0] == [0.0, -2.77]
    assert sought(2.77, 0.0)[3] == IDLE and sought(1.9, 0.0)[3] == MISSED
    assert sought(2.7, 0.0, at=(2.7, -1.2))[0] != [2.7, 0.0]  # from where it is, it would leave
    quay = LandGrid(np.zeros((5, 5), np.bool_), 4.0)
    quay.land[2, 2] = True  # whose sides are 2 m from (4, 4)
    assert sought(2.5, 1.3, reach=REACH._replace(grid=quay))[0] == [2.5, 1.3]
    assert np.isnan(sought(2.5, 1.5, reach=REACH._replace(grid=quay))[0]).all()
    for x, y in ((2.79, 0.0), (2.1, 2.1)):
        wanted, following, _, pickup = sought(x, y)
        assert np.isnan(wanted).all() and following == [x, y] and pickup == IDLE


def test_with_nothing_to_pick_up_a_forager_is_ready_for_the_next_or_looks_round() -> None:
    nowhere = float("nan")
    assert sought(-5.0, 5.0)[1] == [-5.0, 5.0]
    assert np.isnan(sought(-6.5, 6.5)[1]).all()  # more than 9 m away
    assert not sought(-5.0, 5.0, stay=True)[2]
    assert sought(nowhere, nowhere, stay=True)[2]
    assert not sought(nowhere, nowhere)[2]  # on its way elsewhere
    assert not sought(nowhere, nowhere, stay=True, reach=REACH._replace(narrow=False))[2]
    assert not sought(-6.5, 6.5, stay=True)[2]  # it knows of one, and of one given up
    assert not sought(1.0, 0.0, stay=True, later_s=9.0)[2]


def test_a_forager_that_stays_looks_round_until_it_has_seen_an_item() -> None:
    """It knows only what its camera has shown it: once one was sought it looks no more."""
    state, xy, now = state_of([0, 0]), np.full((1, 2, 2, 2), np.nan), np.zeros(1)
    pose, room = np.zeros((1, 2, 3)), np.ones((1, 2), np.int64)
    attempts, sent = Attempts.of(2, state.item_node), sent_to_the_origin(stay=True)

    def looks() -> list[bool]:
        goal = Goal.of(1, 2)
        seek(REACH, attempts, ON, room, pose, xy, sent, now, state, goal)
        return [bool(look) for look in goal.look[0]]

    assert looks() == [False, True]
    xy[0, 1, 1] = 1.0
    assert looks() == [False, False] and state.pickup.tolist() == [[IDLE, MISSED]]
    xy[:] = np.nan
    assert looks() == [False, False]
    state.pickup[:] = IDLE  # the next period
    assert looks() == [False, True]


class Seeking:
    """A forager that heads east, its bow at the origin at first, and two items before it."""

    def __init__(self) -> None:
        self.state, self.now = state_of([0, 0]), 0.0
        self.attempts = Attempts.of(2, self.state.item_node)
        self.xy = np.array([[[[0.2, 0.0], [0.3, 1.0]]] * 2])

    def back_off_to(self, bow: float, seconds: float = 0.5) -> list[float]:
        """Move the bow to so many metres; the item that is sought then."""
        self.now += seconds
        pose = np.array([[[9.0, 0.0, 0.0], [bow - 1.0, 0.0, 0.0]]])
        sent, goal, room = sent_to_the_origin(), Goal.of(1, 2), np.ones((1, 2), np.int64)
        now = np.array([self.now])
        seek(REACH, self.attempts, ON, room, pose, self.xy, sent, now, self.state, goal)
        return [float(x) for x in goal.xy[0, 1]]


def test_after_two_failed_attempts_another_item_is_sought_and_the_reason_told() -> None:
    first, second = [0.2, 0.0], [0.3, 1.0]
    hull = Seeking()
    assert hull.back_off_to(0.0) == first
    assert hull.back_off_to(-1.2) == first  # one attempt has failed
    assert hull.back_off_to(-1.5) == first  # being away longer is not another
    assert hull.back_off_to(-0.2) == first
    assert hull.state.pickup.tolist() == [[IDLE, MISSED]]
    assert ATTEMPTS == 2 and hull.back_off_to(-1.2) == second
    assert hull.state.pickup.tolist() == [[IDLE, UNREACHABLE]]
    hull.state.pickup[:] = IDLE  # the next period
    assert hull.back_off_to(-1.2) == second
    assert hull.state.pickup.tolist() == [[IDLE, MISSED]]
    assert hull.back_off_to(-1.2, LATER_S) == first  # later has come


def test_an_item_taken_is_no_failed_attempt() -> None:
    hull = Seeking()
    for _ in range(3):
        hull.back_off_to(0.0)
        hull.state.item_node[0, 0] = -1
        assert hull.back_off_to(-1.3) == [0.3, 1.0]
        hull.state.item_node[0, 0] = 0
    assert (hull.attempts.failed == 0).all() and (hull.attempts.later_s == 0.0).all()
