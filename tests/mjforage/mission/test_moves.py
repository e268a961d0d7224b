import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.graph.navigation import STAY, NavigationGraph, navigation_graph
from mjforage.mission.moves import MoveRules, Moves, free_move, reachable_share
from mjforage.mission.resolver import Corruption, Resolver
from mjforage.mission.task import Task
from mjforage.scenario.roles import Fleet, Role
from tests.graph_planner.charts import grid

N, E, S, W = 0, 2, 4, 6


def resolve(
    graph: NavigationGraph,
    roles: dict[str, Role],
    cells: list[tuple[int, int]],
    wishes: list[list[int]],
    rules: MoveRules,
    energy: float = np.inf,
    episodes: int = 1,
    corruption: Corruption | None = None,
    belief: NDArray[np.int16] | None = None,
    order: tuple[str, ...] = (),
    owner_of: tuple[int, ...] | None = None,
) -> Moves:
    """Resolve one step in which every agent ranks its wished moves first to last."""
    fleet = Fleet.of(roles, order)
    nodes = np.array([[graph.node_of_cell[rc] for rc in cells]] * episodes, np.int32)
    preferences = np.full((episodes, len(fleet), 9), -np.inf)
    for agent, moves in enumerate(wishes):
        for rank, move in enumerate(moves):
            preferences[:, agent, move] = -rank
    resolver = Resolver(graph, fleet, rules, corruption or Corruption(np.zeros(len(fleet))))
    return resolver(
        np.ones(episodes, np.bool_),
        preferences,
        nodes,
        np.full(nodes.shape, energy),
        np.zeros((episodes, len(graph)), np.int16) if belief is None else belief,
        np.ones(episodes, np.int32),
        episode_keys(0, np.arange(episodes)),
        None if owner_of is None else np.array(owner_of),
    )


def where(graph: NavigationGraph, moves: Moves, agent: int) -> tuple[int, int]:
    target = moves.target[0, agent]
    return int(graph.rows[target]), int(graph.cols[target])


SCOUT, FORAGER = Role(1, 2, 4.0, False), Role(1, 1, 1.0, True)
WATER = navigation_graph(np.ones((5, 5), np.bool_), 1.0, False)
FREE = MoveRules(stay=True, shorten=True)
PUBLISHED = MoveRules(stay=False, shorten=False)


def test_the_forager_decides_first_and_the_scout_gives_way() -> None:
    teams = {"scouts": Role(1, 1, 4.0, False), "foragers": FORAGER}
    moves = resolve(WATER, teams, [(2, 0), (2, 2)], [[E, N], [W]], FREE)
    assert where(WATER, moves, 1) == (2, 1)
    assert where(WATER, moves, 0) == (1, 0)


def test_the_order_of_choosing_is_a_rule_and_not_the_order_of_teams() -> None:
    """Whoever collects goes first wherever its team stands, unless a scenario says otherwise."""
    scout = Role(1, 1, 4.0, False)
    sweeper = Role(2, 1, 2.0, True)
    teams = {"sweepers": sweeper, "relays": scout, "foragers": FORAGER, "scouts": scout}
    assert Fleet.of(teams).order.tolist() == [3, 1, 0, 2, 4]
    assert Fleet.of(teams, ("scouts", "sweepers", "relays", "foragers")).order.tolist() == [
        *(4, 1, 0, 2, 3),
    ]
    turned = {"foragers": FORAGER, "scouts": scout}
    cells, wishes = [(2, 2), (2, 0)], [[W, N], [E, S]]
    by_rule = resolve(WATER, turned, cells, wishes, FREE)
    assert [where(WATER, by_rule, a) for a in (0, 1)] == [(2, 1), (3, 0)]
    asked = resolve(WATER, turned, cells, wishes, FREE, order=("scouts", "foragers"))
    assert [where(WATER, asked, a) for a in (0, 1)] == [(1, 2), (2, 1)]


def test_a_chosen_node_can_neither_be_entered_nor_passed() -> None:
    teams = {"scouts": SCOUT, "foragers": FORAGER}
    cells = [(2, 0), (2, 2)]
    strict = resolve(WATER, teams, cells, [[E, N], [W]], PUBLISHED)
    assert where(WATER, strict, 0) == (0, 0)
    teams = {"scouts": SCOUT, "foragers": FORAGER}
    passing = resolve(WATER, teams, [(2, 0), (1, 2)], [[E], [S]], FREE)
    assert where(WATER, passing, 1) == (2, 2)
    assert where(WATER, passing, 0) == (2, 1) and passing.steps[0, 0] == 1


def test_agents_may_swap_nodes() -> None:
    teams = {"scouts": Role(2, 1, 4.0, False)}
    moves = resolve(WATER, teams, [(2, 1), (2, 2)], [[E], [W]], FREE)
    assert (where(WATER, moves, 0), where(WATER, moves, 1)) == ((2, 2), (2, 1))


@pytest.mark.parametrize(("shorten", "end"), [(True, (0, 1)), (False, (2, 0))])
def test_a_blocked_second_node_shortens_or_forbids_the_move(
    shorten: bool, end: tuple[int, int]
) -> None:
    graph = navigation_graph(grid("..#", "...", "..."), 1.0, False)
    rules = MoveRules(stay=False, shorten=shorten)
    moves = resolve(graph, {"scouts": SCOUT}, [(0, 0)], [[E, S]], rules)
    assert where(graph, moves, 0) == end


def test_staying_put_is_legal_only_where_the_rules_say_so() -> None:
    stay = resolve(WATER, {"scouts": SCOUT}, [(2, 2)], [[STAY, N]], FREE)
    assert stay.direction[0, 0] == STAY and not stay.blocked[0, 0]
    published = resolve(WATER, {"scouts": SCOUT}, [(2, 2)], [[STAY, N]], PUBLISHED)
    assert published.direction[0, 0] == N


def test_without_a_legal_move_an_agent_stays_and_is_blocked() -> None:
    pond = navigation_graph(grid("."), 1.0, False)
    moves = resolve(pond, {"scouts": SCOUT}, [(0, 0)], [[N]], PUBLISHED)
    assert moves.blocked[0, 0] and moves.direction[0, 0] == STAY and moves.target[0, 0] == 0


def test_an_agent_whose_node_is_chosen_by_an_earlier_one_must_leave_it() -> None:
    channel = navigation_graph(grid("..."), 1.0, False)
    teams = {"scouts": Role(1, 1, 1.0, False), "foragers": FORAGER}
    moves = resolve(channel, teams, [(0, 1), (0, 2)], [[STAY, W], [W]], FREE)
    assert where(channel, moves, 0) == (0, 0)


def test_energy_left_limits_the_length_of_a_move() -> None:
    moves = resolve(WATER, {"scouts": SCOUT}, [(2, 2)], [[1, N, STAY]], FREE, energy=2.5)
    assert moves.direction[0, 0] == N  # two diagonal nodes would take 2.83
    tired = resolve(WATER, {"scouts": SCOUT}, [(2, 2)], [[1, N, STAY]], FREE, energy=1.9)
    assert tired.direction[0, 0] == STAY


@pytest.mark.parametrize("shorten", [False, True])
@pytest.mark.parametrize("energy", [0.9, 1.0, 1.9, 2.0])
def test_an_agent_is_exhausted_when_it_can_never_move_again(shorten: bool, energy: float) -> None:
    """Where moves are shortened, a scout of two nodes needs energy for one: for a move that ends
    before another agent. Where they are not, it needs energy for both.
    """
    rules, teams = MoveRules(True, shorten), {"scouts": SCOUT, "foragers": FORAGER}
    task = Task(WATER, Fleet.of(teams), rules, horizon=10)
    wishes = [[E, STAY], [W, STAY]]
    moves = [resolve(WATER, teams, [(2, 0), (2, at)], wishes, rules, energy) for at in (3, 4)]
    able = np.any([move.direction[0] != STAY for move in moves], axis=0)
    assert able.tolist() == [energy >= (1.0 if shorten else 2.0), energy >= 1.0]
    np.testing.assert_array_equal(task.exhausted(np.full(2, energy)), ~able)


def test_unwanted_legal_moves_are_still_taken_when_nothing_else_is_left() -> None:
    channel = navigation_graph(grid(".."), 1.0, False)
    moves = resolve(channel, {"scouts": SCOUT}, [(0, 0)], [[]], MoveRules(False, True))
    assert where(channel, moves, 0) == (0, 1) and not moves.blocked[0, 0]


def test_corruption_replaces_each_action_with_its_probability_by_a_uniform_legal_one() -> None:
    graph = navigation_graph(grid("...", "..."), 1.0, False)
    teams = {"scouts": Role(2, 1, 1.0, False)}
    corruption = Corruption(np.array([0.6, 0.0]))
    moves = resolve(
        graph,
        teams,
        [(0, 0), (0, 2)],
        [[STAY], [STAY]],
        FREE,
        episodes=4000,
        corruption=corruption,
    )
    assert (moves.direction[:, 1] == STAY).all()
    counts = np.bincount(moves.direction[:, 0], minlength=9) / 4000
    legal = {E: 0.15, 3: 0.15, S: 0.15, STAY: 0.55}  # 0.6 / 4 each, and 0.4 left alone
    for move in range(9):
        assert counts[move] == pytest.approx(legal.get(move, 0.0), abs=0.03)


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("shape", r"policy: act gave float64 \(1, 1, 8\), expected numbers of shape \(1, 1, 9\)"),
        ("nan", "policy: gives preferences that are NaN"),
    ],
)
def test_bad_preferences_are_refused(fault: str, words: str) -> None:
    fleet = Fleet.of({"scouts": SCOUT})
    resolver = Resolver(WATER, fleet, FREE, Corruption(np.zeros(1)))
    preferences = np.zeros((1, 1, 8 if fault == "shape" else 9))
    preferences[0, 0, 0] = np.nan if fault == "nan" else 0.0
    node = np.zeros((1, 1), np.int32)
    step, keys = np.ones(1, np.int32), episode_keys(0, np.arange(1))
    energy, belief = np.full((1, 1), np.inf), np.zeros((1, 25), np.int16)
    with pytest.raises(UserError, match=words):
        resolver(np.ones(1, np.bool_), preferences, node, energy, belief, step, keys)


@pytest.mark.parametrize("place", [(0, 1, 8), (1, 0, 0), (1, 1, 8)])
def test_nan_is_refused_wherever_it_is_and_nothing_is_resolved(place: tuple[int, int, int]) -> None:
    """Also of an episode that is over: a policy answers for all rows."""
    fleet = Fleet.of({"scouts": Role(2, 1, 4.0, False)})
    resolver = Resolver(WATER, fleet, FREE, Corruption(np.zeros(2)))
    preferences = np.zeros((2, 2, 9))
    node = np.tile(np.array([0, 1], np.int32), (2, 1))
    step, keys, active = (
        np.ones(2, np.int32),
        episode_keys(0, np.arange(2)),
        np.array([True, False]),
    )
    rest = node, np.full((2, 2), np.inf), np.zeros((2, 25), np.int16), step, keys
    before = resolver(active, preferences, *rest)
    spoiled = preferences.copy()
    spoiled[place] = np.nan
    with pytest.raises(UserError, match="NaN"):
        resolver(active, spoiled, *rest)
    after = resolver(active, preferences, *rest)
    for first, second in zip(before, after, strict=True):
        np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize("stay", [False, True])
@pytest.mark.parametrize("shorten", [False, True])
def test_each_agent_is_shut_in_by_its_own_stride(stay: bool, shorten: bool) -> None:
    """Alone on the map, agents of 2, 1 and 3 nodes per decision take each legal move they ask."""
    graph, rules = (
        navigation_graph(grid(".....", "..#..", "....."), 1.0, False),
        MoveRules(stay, shorten),
    )
    nobody = np.empty(0, np.int64)
    for strides in ((2, 1), (1, 2), (3, 2)):
        teams = {f"t{i}": Role(1, m, 1.0, False) for i, m in enumerate(strides)}
        for agent, stride in enumerate(strides):
            order = (f"t{agent}", f"t{1 - agent}")
            for node in range(len(graph)):
                cell = int(graph.rows[node]), int(graph.cols[node])
                for move in range(9):
                    end, _ = free_move(
                        graph.neighbours, nobody, -1, node, move, stride, stay, shorten
                    )
                    wishes: list[list[int]] = [[], []]
                    wishes[agent] = [move]
                    moves = resolve(graph, teams, [cell, cell], wishes, rules, order=order)
                    assert (moves.direction[0, agent] == move and not moves.blocked[0, agent]) == (
                        end >= 0
                    ) or (move == STAY and end < 0 and moves.blocked[0, agent])


def test_two_node_moves_alone_reach_a_quarter_of_open_water() -> None:
    sea = navigation_graph(np.ones((60, 60), np.bool_), 1.0, False)
    assert reachable_share(sea, 0, 2, PUBLISHED) == 0.25
    assert reachable_share(sea, 0, 2, FREE) == 1.0
    assert reachable_share(sea, 0, 1, PUBLISHED) == 1.0
