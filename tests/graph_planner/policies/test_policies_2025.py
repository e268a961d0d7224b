"""The four baselines of the paper of 2025, sentence by sentence, on maps with known answers."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from mjforage.base.randomness import Stream, stream_key, uniform
from mjforage.graph_planner.graph.navigation import OFFSETS, NavigationGraph, navigation_graph
from mjforage.graph_planner.policies import create_policy
from mjforage.graph_planner.policies.lawnmower_2025 import Lawnmower2025Policy
from mjforage.graph_planner.policies.pso_2025 import Pso2025Policy, _nearest_move
from mjforage.graph_planner.policies.walk_2025 import Walk2025Policy
from mjforage.mission.mission import Mission
from mjforage.mission.moves import FINAL, MoveRules
from mjforage.mission.setup import Setup
from mjforage.mission.task import NEVER, Observation, Task
from mjforage.scenario.roles import Role
from mjforage.scenario.scenario_file import load_scenario
from tests.graph_planner.charts import grid
from tests.graph_planner.driver import observation_of, preferences, task_of

N, NE, E, SE, S, SW, W, NW = range(8)
JUMP = MoveRules(stay=False, shorten=False, jump=True)
Cell = tuple[int, int]


def scouts(count: int = 1, moves: int = 2, radius: float = 4.0) -> Role:
    return Role(count, moves, radius, False)


def foragers(count: int = 1) -> Role:
    return Role(count, 1, 1.0, True)


def water(rows: int, cols: int) -> NavigationGraph:
    return navigation_graph(np.ones((rows, cols), np.bool_), 1.0, True)


def chosen(name: str, task: Task, seen: Observation) -> NDArray[np.int64]:
    """(episode, agent) the final moves."""
    found = preferences(name, task, seen)
    assert ((found >= FINAL).sum(axis=2) == 1).all()
    moves: NDArray[np.int64] = found.argmax(axis=2)
    return moves


def seen_all(task: Task, step: int = 0) -> NDArray[np.int16]:
    return np.full(len(task.graph), step, np.int16)


# greedy-2025


def greedy_scores(task: Task, seen: Observation, agent: int) -> NDArray[np.float64]:
    """(move,) scores straight from the sentences, -inf where the end is no node."""
    graph, role_moves = task.graph, int(task.fleet.moves[agent])
    at, known = seen.agent_node[0, agent], seen.known[0, : seen.n_known[0]]
    fresh = seen.last_seen[0] == NEVER
    weight = 1.0 if (~fresh).mean() > 0.8 else 2.0
    scores = np.full(8, -np.inf)
    for move in range(8):
        row, col = (graph.rows[at], graph.cols[at]) + role_moves * OFFSETS[move]
        if not (0 <= row < graph.shape[0] and 0 <= col < graph.shape[1]):
            continue
        if not graph.navigable[row, col]:
            continue
        away = np.hypot(graph.rows - row, graph.cols - col)
        score = -away[known].min(initial=np.inf) if known.size else 0.0
        if task.fleet.collects[agent]:
            score += 50 * seen.belief[0, graph.node_of_cell[row, col]]
        else:
            score += weight * (fresh & (away <= task.fleet.radius[agent])).sum()
        scores[move] = score
    return scores


@pytest.mark.parametrize("share", [0.3, 0.79, 0.82, 1.0])
@pytest.mark.parametrize("items", [0, 1, 9])
def test_greedy_takes_the_largest_score(
    ragged_coast: NavigationGraph, share: float, items: int
) -> None:
    """Of all moves, in 40 situations: distances across land, the disc through it, the 80 % rule."""
    graph, rng = ragged_coast, np.random.default_rng(items)
    for role in (scouts(), foragers()):
        task = task_of(graph, JUMP, team=role)
        for _ in range(20):
            nodes = rng.choice(len(graph), 1 + items, replace=False)
            near = graph.neighbours[nodes[0]]
            if items > 1:
                nodes[1:3] = near[near >= 0][:2]
            cells = [(int(graph.rows[v]), int(graph.cols[v])) for v in nodes]
            last_seen = np.full(len(graph), NEVER, np.int16)
            last_seen[rng.permutation(len(graph))[: round(share * len(graph))]] = 0
            known = {cell: int(rng.integers(1, 4)) for cell in cells[1:]}
            seen = observation_of(task, cells[:1], known, last_seen)
            scores = greedy_scores(task, seen, 0)
            move = chosen("greedy-2025", task, seen)[0, 0]
            assert scores[move] == pytest.approx(scores.max(), abs=1e-9)


def test_greedy_counts_a_new_node_twice_until_more_than_80_percent_were_seen() -> None:
    """Two nodes west the item is nearer by 4, two nodes east are 2 new nodes: as good while 16 of
    20 were seen, less at 17."""
    task = task_of(water(1, 20), JUMP, scouts=scouts(1, 2, 1.0))
    for far, share in (((18, 19), 0.5), ((19,), 0.0)):
        last_seen = seen_all(task)
        last_seen[[12, 13, *far]] = NEVER
        seen = observation_of(task, [(0, 10)], {(0, 4): 1}, last_seen, 9, 400)
        moves = chosen("greedy-2025", task, seen)
        assert (moves == E).mean() == pytest.approx(share, abs=0.1)
        assert np.isin(moves, (E, W)).all()


def test_greedy_lets_the_highest_number_choose_first_and_closes_its_end_node() -> None:
    """All want (2, 2): the last forager gets it, the other (1, 1); the scout, which chooses after
    them, ends at (0, 2), nearest to (1, 1)."""
    task = task_of(water(5, 9), JUMP, scouts=scouts(1, 2, 1.0), foragers=foragers(2))
    known = {(2, 2): 2, (1, 1): 1}
    seen = observation_of(task, [(2, 4), (2, 1), (2, 1)], known, seen_all(task))
    assert chosen("greedy-2025", task, seen)[0].tolist() == [NW, N, E]


def test_greedy_breaks_ties_at_random() -> None:
    task = task_of(water(7, 12), JUMP, foragers=foragers(2))
    apart = [(3, 3), (3, 8)]
    moves = chosen("greedy-2025", task, observation_of(task, apart, episodes=800))
    for agent in (0, 1):
        assert stats.chisquare(np.bincount(moves[:, agent], minlength=8)).pvalue > 0.001
    assert (moves[:, 0] == moves[:, 1]).mean() == pytest.approx(1 / 8, abs=0.05)
    two = observation_of(task, apart, {(2, 3): 1, (4, 3): 1}, episodes=800)
    north = int((chosen("greedy-2025", task, two)[:, 0] == N).sum())
    assert stats.binomtest(north, 800).pvalue > 0.001


def test_greedy_without_a_free_end_node_moves_at_random() -> None:
    """Onto land too, where it stays and closes its node, and onto the end node of another."""
    pair = navigation_graph(grid("..", "##"), 1.0, True)
    task = task_of(pair, JUMP, foragers=foragers(3))
    seen = observation_of(task, [(0, 1), (0, 0), (0, 0)], episodes=1600)
    first, second, third = chosen("greedy-2025", task, seen).T
    assert (third == E).all()
    assert stats.chisquare(np.bincount(second, minlength=8)).pvalue > 0.001
    assert (first[second == E] == W).all()
    assert stats.chisquare(np.bincount(first[second != E], minlength=8)).pvalue > 0.001


# pso-2025


def pso(task: Task, seen: Observation) -> Pso2025Policy:
    policy = create_policy("pso-2025")
    assert isinstance(policy, Pso2025Policy)
    policy.reset(task, seen.keys)
    return policy


@pytest.mark.parametrize(
    ("velocity", "closed", "move"),
    [
        ((0.0, 0.0), (), S),
        ((0.0, 0.0), (S,), E),
        ((0.5, 0.5), (), S),
        ((0.5, 0.5), (S,), SE),
        ((0.5, 0.5), (S, SE), E),
        ((-0.5, 0.5), (), E),
        ((-0.5, 0.5), (E,), NE),
        ((-0.9, -0.9), (), NW),
        ((0.0, -1.0), tuple(range(8)), S),
    ],
)
def test_the_nearest_free_move_is_taken_and_ties_go_from_south_by_east_on(
    velocity: Cell, closed: tuple[int, ...], move: int
) -> None:
    targets = np.arange(9, dtype=np.int32)
    taken = np.array([*closed, 99], np.int32)
    on_land = np.where(np.isin(targets, closed), -1, targets).astype(np.int32)
    for length in (1, 2):
        speed = length * np.array(velocity)
        assert _nearest_move(speed, length, targets, taken, len(closed)) == move
        assert _nearest_move(speed, length, on_land, taken, 0) == move


def drawn(seen: Observation, agent: int, term: int) -> float:
    key = stream_key(seen.keys[0], Stream.POLICY)
    return uniform(key, 4 * agent + term, int(seen.step[0]))


@pytest.mark.parametrize(
    ("step", "believed", "weights"),
    [
        (76, True, (0.5, 0.0, 3.2697, 0.0)),
        (77, True, (3.6845, 1.5614, 0.0, 3.6703)),
        (77, False, (0.5, 0.0, 3.2697, 0.0)),
    ],
)
@pytest.mark.parametrize("collects", [False, True])
def test_each_term_has_its_weight_and_its_draw(
    step: int, believed: bool, weights: tuple[float, ...], collects: bool
) -> None:
    """Own best place (6, 2) to the west, richest (6, 10) to the east, unseen (0, 6) to the north,
    nearest (8, 6) to the south; v is 0 at the start."""
    role = foragers(2) if collects else scouts(2, 2, 1.0)
    task = task_of(water(13, 13), JUMP, team=role)
    last_seen = seen_all(task)
    last_seen[task.graph.node_of_cell[0, 6]] = NEVER
    known = {(6, 10): 5, (8, 6): 1} if believed else {}
    seen = observation_of(task, [(6, 6)] * 2, known, last_seen, step)
    policy = pso(task, seen)
    policy.swarm.best_node[:], policy.swarm.best_items[:] = task.graph.node_of_cell[6, 2], 99
    policy.act(seen)
    c = (0.0, 2.0, 0.0, 3.0) if collects and believed else weights
    for agent in (0, 1):
        west, east, north, south = (c[term] * drawn(seen, agent, term) for term in range(4))
        v = np.array([2 * south - 6 * north, 4 * east - 4 * west])
        v *= task.fleet.moves[0] / (np.hypot(*v) + 0.01)
        np.testing.assert_allclose(policy.swarm.velocity[0, agent], v, rtol=1e-12)


def test_the_velocity_goes_on_without_a_factor() -> None:
    task = task_of(water(13, 13), JUMP, foragers=foragers())
    last_seen = seen_all(task)
    last_seen[task.graph.node_of_cell[6, 12]] = NEVER
    first = observation_of(task, [(6, 6)], {}, last_seen, 1)
    policy = pso(task, first)
    policy.act(first)
    before = policy.swarm.velocity[0, 0].copy()
    last_seen[:] = 1  # nothing is unseen any more, and nothing believed: no place pulls
    policy.act(observation_of(task, [(6, 7)], {}, last_seen, 2))
    after = policy.swarm.velocity[0, 0]
    np.testing.assert_allclose(after, before / (np.hypot(*before) + 0.01), rtol=1e-12)


def test_the_own_best_place_is_where_most_items_were_in_view_the_latest_of_equals() -> None:
    task = task_of(water(3, 9), JUMP, foragers=foragers())
    node, one = task.graph.node_of_cell, observation_of(task, [(1, 1)], {(1, 1): 2, (1, 2): 1})
    policy = pso(task, one)
    places = []
    for col, known in ((1, {(1, 1): 2, (1, 2): 1}), (4, {(1, 4): 2}), (6, {(1, 5): 2, (1, 7): 1})):
        policy.act(observation_of(task, [(1, col)], known, seen_all(task)))
        places.append(int(policy.swarm.best_node[0, 0]))
    assert places == [node[1, 1], node[1, 1], node[1, 6]]


def test_equal_places_go_by_rows() -> None:
    """Four unseen nodes as near: (2, 4) comes first. Of two as rich, or as near: the upper one."""
    task = task_of(water(9, 9), JUMP, foragers=foragers())
    last_seen = seen_all(task)
    for cell in ((6, 4), (4, 6), (4, 2), (2, 4)):
        last_seen[task.graph.node_of_cell[cell]] = NEVER
    seen = observation_of(task, [(4, 4)], {}, last_seen)
    policy = pso(task, seen)
    assert policy.act(seen)[0, 0].argmax() == N
    for known in ({(8, 4): 3, (0, 4): 3, (4, 4): 1}, {(5, 4): 1, (3, 4): 1, (4, 8): 2}):
        for listed in (known, dict(reversed(known.items()))):
            seen = observation_of(task, [(4, 4)], listed, seen_all(task))
            policy = pso(task, seen)
            policy.act(seen)
            assert policy.swarm.velocity[0, 0, 0] < 0.0


def test_the_swarm_chooses_one_after_the_other_and_without_a_free_move_goes_south() -> None:
    task = task_of(water(3, 5), JUMP, foragers=foragers(2))
    seen = observation_of(task, [(1, 1), (1, 1)], {(1, 4): 1}, seen_all(task))
    first, second = pso(task, seen).act(seen)[0].argmax(axis=1)
    assert second == E and first in (NE, SE)
    pond = task_of(navigation_graph(grid(".."), 1.0, True), JUMP, foragers=foragers(2))
    seen = observation_of(pond, [(0, 0), (0, 0)], {(0, 1): 1}, seen_all(pond))
    assert pso(pond, seen).act(seen)[0].argmax(axis=1).tolist() == [S, E]


# (row, column) of the moves as they are numbered there
TURNS = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))


class PlainSwarm:
    """Moves of one episode's swarm, straight from the sentences."""

    def __init__(self, task: Task) -> None:
        self.task, agents = task, len(task.fleet)
        self.velocity, self.best = np.zeros((agents, 2)), [(0, -1)] * agents

    def moves(self, seen: Observation) -> dict[int, Cell]:
        """Agent -> (row, column) of its move [node]."""
        task, graph = self.task, self.task.graph
        at, cells = np.stack((graph.rows, graph.cols), 1).astype(np.int64), graph.node_of_cell
        key, belief = stream_key(seen.keys[0], Stream.POLICY), seen.belief[0]
        believed, new = np.flatnonzero(belief), np.flatnonzero(seen.last_seen[0] == NEVER)
        found: dict[int, Cell] = {}
        taken = set[int]()
        for a in range(len(task.fleet) - 1, -1, -1):  # foragers have the higher numbers
            here, length = seen.agent_node[0, a], int(task.fleet.moves[a])
            away = ((at - at[here]) ** 2).sum(axis=1)
            in_view = int(belief[away <= task.fleet.radius[a] ** 2].sum())
            if in_view >= self.best[a][0]:
                self.best[a] = in_view, here
            c = (0.5, 0.0, 3.2697, 0.0)
            if believed.size and task.fleet.collects[a]:
                c = (0.0, 2.0, 0.0, 3.0)
            elif believed.size and seen.step[0] > 76:
                c = (3.6845, 1.5614, 0.0, 3.6703)
            places = [self.best[a][1], here, here, here]
            if believed.size:
                places[1] = believed[belief[believed].argmax()]
                places[3] = believed[away[believed].argmin()]
            if new.size:
                places[2] = new[away[new].argmin()]
            v = self.velocity[a]
            for term, place in enumerate(places):
                u = uniform(key, 4 * a + term, int(seen.step[0]))
                v += c[term] * u * (at[place] - at[here])
            v *= length / (np.hypot(*v) + 0.01)
            ends: dict[Cell, int] = {}
            for way in TURNS:
                row, col = at[here] + length * np.array(way)
                inside = 0 <= row < graph.shape[0] and 0 <= col < graph.shape[1]
                ends[way] = int(cells[row, col]) if inside else -1
            free = [way for way in TURNS if ends[way] >= 0 and ends[way] not in taken]
            apart = [((v - length * np.array(way)) ** 2).sum() for way in free]
            found[a] = free[int(np.argmin(apart))] if free else (1, 0)
            taken.add(ends[found[a]] if ends[found[a]] >= 0 else int(here))
        return found


@pytest.mark.parametrize(("map_name", "count"), [("comb_port", 2), ("channels", 6)])
def test_the_swarm_plays_whole_episodes_by_the_sentences(map_name: str, count: int) -> None:
    teams = f"team.foragers.count={count}", f"team.scouts.count={count}"
    scenario = load_scenario("published-2025", (f"map.file={map_name}", "map.starts=[]", *teams))
    mission, policy = Mission(Setup.of(scenario)), create_policy("pso-2025")
    mission.reset(3, np.arange(1))
    mission.prepare(policy)
    plain = PlainSwarm(mission.task)
    while mission.active.any():
        seen = mission.owner_observation
        answer = policy.act(seen)
        for a, move in plain.moves(seen).items():
            assert tuple(OFFSETS[answer[0, a].argmax()]) == move, (a, seen.step)
        mission.advance(answer)


# lawnmower-2025 and walk-2025


def walked(
    policy: Lawnmower2025Policy | Walk2025Policy, task: Task, seen: Observation, steps: int
) -> list[list[Cell]]:
    """Cells of every agent of the first row after each of some decisions."""
    graph, cells = task.graph, []
    for _ in range(steps):
        for agent, move in enumerate(policy.act(seen)[0].argmax(axis=1)):
            table = task.arrays.targets[task.arrays.stride_number[agent]]
            end = table[seen.agent_node[0, agent], move]
            seen.agent_node[0, agent] = end if end >= 0 else seen.agent_node[0, agent]
        seen.step[:] += 1
        cells.append([(int(graph.rows[v]), int(graph.cols[v])) for v in seen.agent_node[0]])
    return cells


def mown(rows: list[str], start: Cell, forward: int, steps: int) -> list[Cell]:
    task = task_of(navigation_graph(grid(*rows), 1.0, True), JUMP, foragers=foragers())
    seen = observation_of(task, [start], {(0, 0): 9})
    policy = create_policy("lawnmower-2025")
    assert isinstance(policy, Lawnmower2025Policy)
    policy.reset(task, seen.keys)
    policy.mower.forward[:] = forward
    return [one for (one,) in walked(policy, task, seen, steps)]


def test_the_lawnmower_goes_forward_aside_back_and_aside() -> None:
    """North, two to the east, south, two to the same side, north again, and one where land is."""
    path = mown(["......"] * 3, (1, 0), N, 11)
    assert path == [
        *((0, 0), (0, 1), (0, 2), (1, 2), (2, 2)),
        *((2, 3), (2, 4), (1, 4), (0, 4), (0, 5), (1, 5)),
    ]


def test_the_lawnmower_backs_out_until_its_side_is_free() -> None:
    """North into a dead end at (0, 0); the side is land there and at (1, 0), and free at (2, 0)."""
    path = mown([".##", ".##", "...", "..."], (3, 0), N, 8)
    assert path == [(2, 0), (1, 0), (0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (3, 2)]


def test_a_blocked_choice_makes_the_side_the_forward_direction_and_is_tried_at_once() -> None:
    """At (0, 1) north, east and the way out, south, are blocked: east becomes forward, blocked too,
    and the agent stays. Then south is its side: out is west, and at the end of it south is tried.
    """
    assert mown(["..", "##"], (0, 1), N, 3) == [(0, 1), (0, 0), (0, 0)]


def test_the_count_of_side_moves_is_kept_unless_a_lane_follows() -> None:
    """Two to the east, and no way back at (0, 2): east becomes forward, with two moves counted. Its
    sideways leg is one move then, and the next, after a lane, two again."""
    assert mown(["......", "..#...", "......", "......"], (0, 0), N, 10) == [
        *((0, 1), (0, 2), (0, 3), (0, 4), (0, 5)),
        *((1, 5), (1, 4), (1, 3), (2, 3), (3, 3)),
    ]


@pytest.mark.parametrize("name", ["lawnmower-2025", "walk-2025"])
def test_they_draw_their_directions_and_share_nodes(name: str) -> None:
    task = task_of(water(5, 5), JUMP, foragers=foragers(2))
    seen = observation_of(task, [(2, 2), (2, 2)], episodes=800)
    moves = chosen(name, task, seen)
    assert stats.chisquare(np.bincount(moves.ravel(), minlength=8)).pvalue > 0.001
    assert 0.05 < (moves[:, 0] == moves[:, 1]).mean() < 0.25


def test_a_walk_goes_on_until_it_is_blocked_and_never_straight_back() -> None:
    task = task_of(water(6, 6), JUMP, 400, foragers=foragers())
    seen = observation_of(task, [(0, 0)], {(0, 0): 3})
    policy = create_policy("walk-2025")
    assert isinstance(policy, Walk2025Policy)
    policy.reset(task, seen.keys)
    path = [(0, 0), *(cell for (cell,) in walked(policy, task, seen, 300))]
    steps = np.diff(np.array(path), axis=0)
    assert (np.abs(steps).max(axis=1) == 1).all()
    for at, before, after in zip(path[1:], steps, steps[1:], strict=False):
        onward = np.array(at) + before
        blocked = ((onward < 0) | (onward > 5)).any()
        assert (after == before).all() != blocked
        assert not (after == -before).all()


def test_a_walk_with_no_way_but_back_takes_any_of_eight() -> None:
    """It goes east to the end of a row of two nodes, in which it may also stay and turn back."""
    task = task_of(navigation_graph(grid(".."), 1.0, True), JUMP, foragers=foragers())
    first = observation_of(task, [(0, 0)], episodes=800)
    policy = create_policy("walk-2025")
    policy.reset(task, first.keys)
    assert (policy.act(first)[:, 0].argmax(axis=1) == E).all()
    there = observation_of(task, [(0, 1)], step=2, episodes=800)
    moves = policy.act(there)[:, 0].argmax(axis=1)
    assert stats.chisquare(np.bincount(moves, minlength=8)).pvalue > 0.001
