"""The swarm of the paper of 2025, sentence by sentence."""

import numpy as np
import pytest

from mjforage.base.randomness import Stream, stream_key, uniform
from mjforage.graph_planner.graph.navigation import OFFSETS, navigation_graph
from mjforage.graph_planner.policies import create_policy
from mjforage.graph_planner.policies.pso_2025 import Pso2025Policy, _nearest_move
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.mission.task import NEVER, Observation, Task
from mjforage.scenario.scenario_file import load_scenario
from tests.graph_planner.charts import grid
from tests.graph_planner.driver import observation_of, task_of
from tests.graph_planner.policies.test_policies_2025 import (
    JUMP,
    Cell,
    foragers,
    scouts,
    seen_all,
    water,
)

N, NE, E, SE, S, SW, W, NW = range(8)


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
