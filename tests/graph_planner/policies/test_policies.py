import copy
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from mjforage.base.errors import UserError
from mjforage.base.randomness import Stream, episode_keys, stream_key
from mjforage.graph_planner.graph.navigation import STAY, NavigationGraph, navigation_graph
from mjforage.graph_planner.policies import create_policy, register
from mjforage.graph_planner.policies.greedy import _saturation
from mjforage.graph_planner.policies.lawnmower import LawnmowerPolicy, lane_corners
from mjforage.graph_planner.policies.registry import policy_files
from mjforage.graph_planner.policies.walks import LevyPolicy, levy_length
from mjforage.mission.moves import MoveRules
from mjforage.scenario.roles import Role
from tests.graph_planner.charts import grid
from tests.graph_planner.driver import FREE, observation_of, preferences, task_of

SCOUT, FORAGER = Role(1, 2, 4.0, False), Role(1, 1, 1.0, True)
N, NE, E, SE, S, SW, W, NW = range(8)


def test_an_unknown_policy_is_named_with_the_nearest_one() -> None:
    with pytest.raises(UserError, match="policy gredy: unknown; did you mean greedy"):
        create_policy("gredy")


def test_a_file_that_a_policy_of_that_name_does_not_read_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    shipped = policy_files("ddqn")
    assert len(shipped) == 1 and not caplog.messages
    for name, read in (("ddqn", shipped), ("greedy", ())):
        Path(f"{name}.safetensors").write_bytes(b"mine")
        assert policy_files(name) == read
        assert f"{name}.safetensors in the present folder is not read" in caplog.text
    caplog.clear()
    monkeypatch.chdir(shipped[0].parent)  # where the file is the shipped one
    assert policy_files("ddqn") == shipped
    assert not caplog.messages


def test_a_name_is_registered_once() -> None:
    with pytest.raises(ValueError, match="'greedy' is registered already"):
        register("greedy")(lambda: create_policy("random"))


def greedy_by_hand(
    graph: NavigationGraph,
    role: Role,
    start: int,
    known: dict[int, int],
    idle: NDArray[np.float64],
    rules: MoveRules,
) -> list[float]:
    """Reward of every move by the formula of the docstring, straight from the definitions."""
    rewards = []
    for d in range(9):
        target, steps = start, 0
        while d != STAY and steps < role.nodes and graph.neighbours[target, d] >= 0:
            target, steps = int(graph.neighbours[target, d]), steps + 1
        legal = rules.stay if d == STAY else steps == role.nodes or (steps > 0 and rules.shorten)
        if not legal:
            rewards.append(-np.inf)
            continue
        reward = -1.7 * min((float(graph.distances[target, k]) for k in known), default=0.0)
        if role.collects:
            reward += 5.91 * known.get(target, 0)
        else:
            d_row, d_col = graph.rows - graph.rows[target], graph.cols - graph.cols[target]
            reward += 2.23 * idle[d_row**2 + d_col**2 <= role.radius**2].sum()
        rewards.append(reward)
    return rewards


@pytest.mark.parametrize("rules", [FREE, MoveRules(stay=False, shorten=False)])
@pytest.mark.parametrize("n_known", [0, 1, 12])
def test_greedy_gives_every_move_the_reward_of_its_formula(
    ragged_coast: NavigationGraph, rules: MoveRules, n_known: int
) -> None:
    graph, rng = ragged_coast, np.random.default_rng(n_known)
    task = task_of(graph, rules, scouts=SCOUT, foragers=FORAGER)
    for step in (1, 60, 149):
        nodes = rng.choice(len(graph), 2 + n_known, replace=False)
        beside = graph.neighbours[nodes[1]]
        nodes[2:5] = beside[beside >= 0][: nodes[2:5].size]  # items within the forager's reach
        cells = [(int(graph.rows[v]), int(graph.cols[v])) for v in nodes]
        known = {int(v): int(rng.integers(1, 5)) for v in nodes[2:]}
        last_seen = rng.integers(0, step, len(graph)).astype(np.int16)
        last_seen[rng.random(len(graph)) < 0.3] = np.iinfo(np.int16).min
        idle = np.minimum(1.0, (step - 1 - last_seen.astype(float)) / (0.9 * 150))
        seen = dict(zip(cells[2:], known.values(), strict=True))
        got = preferences("greedy", task, observation_of(task, cells[:2], seen, last_seen, step))
        for agent, role in enumerate((SCOUT, FORAGER)):
            expected = greedy_by_hand(graph, role, int(nodes[agent]), known, idle, rules)
            np.testing.assert_allclose(got[0, agent], expected, atol=2e-5)


def test_greedy_breaks_ties_at_random(open_water: NavigationGraph) -> None:
    task = task_of(open_water, foragers=FORAGER)
    best = preferences("greedy", task, observation_of(task, [(7, 7)], episodes=900)).argmax(axis=2)
    counts = np.bincount(best.ravel(), minlength=9)
    assert stats.chisquare(counts).pvalue > 0.001


@pytest.mark.parametrize("policy", ["levy", "wanderer", "lawnmower"])
def test_foragers_take_a_shortest_path_to_the_nearest_known_item(
    ragged_coast: NavigationGraph, policy: str
) -> None:
    """From every node of the map, to several sets of items."""
    graph, rng = ragged_coast, np.random.default_rng(1)
    task = task_of(graph, foragers=FORAGER)
    everywhere = np.arange(len(graph))
    for _ in range(12):
        items = rng.choice(len(graph), 3, replace=False)
        known = {(int(graph.rows[v]), int(graph.cols[v])): 1 for v in items}
        observation = observation_of(task, [next(iter(known))], known, episodes=len(graph))
        observation.agent_node[:, 0] = everywhere
        move = preferences(policy, task, observation)[:, 0].argmax(axis=1)
        end = np.where(move == STAY, everywhere, graph.neighbours[everywhere, move % 8])
        cost = np.where(move == STAY, 0.0, np.where(move % 2 == 1, 2**0.5, 1.0))
        nearest = graph.distances[:, items].min(axis=1)
        away = ~np.isin(everywhere, items)
        np.testing.assert_allclose((cost + nearest[end])[away], nearest[away], atol=1e-5)
        assert np.isin(end[items], items).all()  # stays, or goes on to the next item beside


def test_levy_lengths_are_levy_distributed_and_capped() -> None:
    key = np.uint64(stream_key(episode_keys(0, np.arange(1))[0], Stream.POLICY))
    lengths = np.array([levy_length(key, i, 1, 50) for i in range(20000)])
    assert lengths.min() == 1 and lengths.max() == 50
    for x in (2, 5, 20, 50):
        assert (lengths >= x).mean() == pytest.approx(stats.levy.sf(x), abs=0.015)


def test_walks_are_at_most_four_fifths_of_the_longer_side() -> None:
    graph = navigation_graph(np.ones((10, 6), np.bool_), 1.0, False)
    assert LevyPolicy()._longest(task_of(graph, scouts=SCOUT)) == 8


def walk(
    policy_name: str, graph: NavigationGraph, steps: int, episodes: int = 40
) -> tuple[list[NDArray[np.int64]], list[NDArray[np.int32]]]:
    """Headings and nodes of a lone one-node scout that always gets its first choice."""
    task = task_of(graph, horizon=steps, scouts=Role(1, 1, 1.0, False))
    start = (int(graph.rows[0]), int(graph.cols[0]))
    observation = observation_of(task, [start], episodes=episodes)
    policy = create_policy(policy_name)
    policy.reset(task, observation.keys)
    headings, nodes = [], []
    for step in range(1, steps + 1):
        observation.step[:] = step
        best = policy.act(observation)[:, 0].argmax(axis=1)
        assert (graph.neighbours[observation.agent_node[:, 0], best] >= 0).all()
        observation.agent_node[:, 0] = graph.neighbours[observation.agent_node[:, 0], best]
        headings.append(best)
        nodes.append(observation.agent_node[:, 0].copy())
    return headings, nodes


def test_a_wanderer_keeps_its_heading_until_blocked_and_never_turns_straight_back() -> None:
    graph = navigation_graph(np.ones((9, 12), np.bool_), 1.0, False)
    headings, nodes = walk("wanderer", graph, 120)
    turns = 0
    for before, after, node in zip(headings, headings[1:], nodes, strict=False):
        could_go_on = graph.neighbours[node, before] >= 0
        assert (after[could_go_on] == before[could_go_on]).all()
        assert (after != (before + 4) % 8).all()
        turns += int((after != before).sum())
    assert turns > 100


def test_a_wanderer_turns_back_only_in_a_dead_end() -> None:
    graph = navigation_graph(grid("....."), 1.0, False)
    headings, _ = walk("wanderer", graph, 9, episodes=1)
    assert [int(h[0]) for h in headings] == [E] * 4 + [W] * 4 + [E]


def test_an_obstacle_turns_a_levy_walk_and_leaves_its_length() -> None:
    graph = navigation_graph(np.ones((9, 12), np.bool_), 1.0, False)
    steps, episodes, cap = 60, 40, 9
    headings, nodes = walk("levy", graph, steps, episodes)
    keys = observation_of(task_of(graph, scouts=SCOUT), [(0, 0)], episodes=episodes).keys
    free_turns = blocked_turns = 0
    for e in range(episodes):
        key, draws, step = np.uint64(stream_key(keys[e], Stream.POLICY)), set(), 1
        while step <= steps:  # a length is used up before the next one is drawn
            draws.add(step)
            step += levy_length(key, 1, step, cap)
        for step in range(2, steps + 1):
            before, after = headings[step - 2][e], headings[step - 1][e]
            free = graph.neighbours[nodes[step - 2][e], before] >= 0
            free_turns += int(free and after != before)
            blocked_turns += int(not free and step not in draws)
            assert not free or after == before or step in draws
    assert free_turns > 100 and blocked_turns > 100


def test_lanes_run_back_and_forth_over_every_stretch_of_water() -> None:
    graph = navigation_graph(grid(".....", "..#..", "....."), 1.0, False)
    corners = [(int(graph.rows[v]), int(graph.cols[v])) for v in lane_corners(graph, 1)]
    assert corners == [(0, 0), (0, 4), (1, 4), (1, 3), (1, 1), (1, 0), (2, 0), (2, 4)]


def test_the_lawnmower_sees_all_of_an_open_map() -> None:
    graph = navigation_graph(np.ones((30, 22), np.bool_), 1.0, False)
    headings, nodes = walk("lawnmower", graph, 420, episodes=1)
    visited = {int(node[0]) for node in nodes}
    views = graph.views((1.0,))
    assert {int(v) for node in visited for v in views.of(node)} == set(range(len(graph)))
    assert len(headings) == 420


def test_pso_foragers_fly_to_the_only_known_item_and_scouts_to_the_most_idle_node() -> None:
    graph = navigation_graph(np.ones((21, 21), np.bool_), 1.0, False)
    task = task_of(graph, scouts=SCOUT, foragers=FORAGER)
    last_seen = np.full(len(graph), 29, np.int16)
    last_seen[graph.node_of_cell[10, 0]] = 0
    for cell, direction in (((2, 10), N), ((18, 18), SE), ((10, 3), W)):
        observation = observation_of(task, [(10, 10), (10, 10)], {cell: 1}, last_seen, step=30)
        scout, forager = preferences("pso", task, observation)[0]
        assert int(forager.argmax()) == direction
        assert int(scout.argmax()) == W


def test_pso_scouts_remember_the_richest_node_they_saw_themselves() -> None:
    graph = navigation_graph(np.ones((21, 21), np.bool_), 1.0, False)
    task = task_of(graph, scouts=Role(1, 1, 4.0, False))
    policy = create_policy("pso")
    idle_here = np.full(len(graph), 0, np.int16)  # everything equally idle: the own node is nearest
    near = observation_of(task, [(10, 10)], {(10, 7): 5}, idle_here, step=1)
    policy.reset(task, near.keys)
    assert int(policy.act(near)[0, 0].argmax()) == W
    far = observation_of(task, [(10, 20)], {(10, 7): 5}, idle_here, step=2)
    assert int(policy.act(far)[0, 0].argmax()) == W


def test_pso_pulls_have_the_published_weights() -> None:
    """Two places at right angles, both 10 away: the nearer pull wins when a > tan(67.5 deg) b.

    With weights w1, w2 and uniforms r1, r2 the second place is flown to straight when
    r1 < tan(22.5 deg) (w2 / w1) r2, which has probability 1 - w1 / (2 tan(22.5 deg) w2).
    """
    graph = navigation_graph(np.ones((41, 41), np.bool_), 1.0, False)
    task = task_of(graph, scouts=SCOUT, foragers=FORAGER)
    seen = np.full(len(graph), 1, np.int16)
    seen[graph.node_of_cell[10, 20]] = 0
    # The scout saw five items 3 to the west itself; the most idle node is 10 to the north.
    known = {(20, 17): 5, (20, 20): 0}
    observation = observation_of(task, [(20, 20), (20, 20)], known, seen, 3, 6000)
    observation.n_known[:] = 0
    scout = preferences("pso", task, observation)[:, 0].argmax(axis=1)
    # pull west 0.5 * 3 r1, pull north 3.27 * 10 r2: north unless 1.5 r1 > 32.7 tan(22.5 deg) r2
    tangent = np.tan(np.pi / 8)
    ratio = 1.5 / (32.7 * tangent)
    assert (scout == N).mean() == pytest.approx(1 - ratio / 2, abs=0.012)
    # Richest 3 items 10 to the west, nearest 1 item 8 to the north.
    observation = observation_of(task, [(20, 20)] * 2, {(20, 10): 3, (12, 20): 1}, seen, 3, 6000)
    forager = preferences("pso", task, observation)[:, 1].argmax(axis=1)
    ratio = 2 * 10 / (3 * 8 * tangent)  # north when r2 > ratio r1, ratio > 1
    assert (forager == N).mean() == pytest.approx(1 / (2 * ratio), abs=0.02)


def test_lanes_are_two_radii_and_a_node_apart() -> None:
    graph = navigation_graph(np.ones((46, 9), np.bool_), 1.0, False)
    task = task_of(graph, scouts=SCOUT)
    policy = LawnmowerPolicy()
    policy.reset(task, episode_keys(0, np.arange(1)))
    rows = graph.rows[policy.sweep.corners]
    assert np.unique(rows).tolist() == [4, 13, 22, 31, 40]


def test_random_moves_are_uniform_over_all_nine() -> None:
    graph = navigation_graph(np.ones((5, 5), np.bool_), 1.0, False)
    task = task_of(graph, scouts=SCOUT)
    observation = observation_of(task, [(2, 2)], episodes=4500)
    counts = np.bincount(preferences("random", task, observation)[:, 0].argmax(axis=1), minlength=9)
    assert stats.chisquare(counts).pvalue > 0.001


@pytest.mark.parametrize("name", ["greedy", "random"])
def test_a_policy_answers_alike_for_arrays_of_another_layout_and_from_a_copy(name: str) -> None:
    graph = navigation_graph(np.ones((6, 6), np.bool_), 1.0, False)
    task = task_of(graph, scouts=SCOUT)
    observation = observation_of(task, [(2, 2)], {(4, 4): 2}, episodes=3)
    policy = create_policy(name)
    policy.reset(task, observation.keys)
    expected = policy.act(observation).copy()
    odd = observation._replace(
        step=observation.step.astype(np.int64),
        last_seen=np.repeat(observation.last_seen, 2, axis=1)[:, ::2],
        belief=np.asfortranarray(observation.belief),
    )
    assert (policy.act(odd) == expected).all()
    twin, later = copy.deepcopy(policy), observation._replace(step=observation.step + 1)
    assert (twin.act(later) == policy.act(later)).all()
    assert (twin.act(observation) == expected).all()


def test_a_node_is_saturated_at_the_first_age_of_idleness_one() -> None:
    assert _saturation(1.0 / 135.0) == 135
    assert _saturation(1.0 / (0.9 * 148)) == 134  # 133.2 steps
