import numpy as np

from mjforage.graph_planner.encodings import LegalMoves
from mjforage.graph_planner.graph.navigation import STAY, navigation_graph
from mjforage.mission.moves import MoveRules
from mjforage.scenario.roles import Role
from tests.graph_planner.charts import grid
from tests.graph_planner.driver import task_of


def mask(rules: MoveRules, energy: float, moves: int = 1, *rows: str) -> list[int]:
    graph = navigation_graph(grid(*rows), 1.0, True)
    task = task_of(graph, rules, scouts=Role(1, moves, 1.0, False))
    return np.flatnonzero(
        LegalMoves(task)(np.zeros((1, 1), np.int32), np.full((1, 1), energy))[0, 0]
    ).tolist()


def test_land_rules_and_energy_decide() -> None:
    free, strict = MoveRules(True, True), MoveRules(False, False)
    assert mask(free, np.inf, 1, "..", "..") == [2, 3, 4, STAY]
    assert mask(strict, np.inf, 1, "..", "..") == [2, 3, 4]
    assert mask(strict, np.inf, 2, "..", "..") == [STAY]  # nothing is legal: it stays, blocked
    assert mask(free, 1.2, 1, "..", "..") == [2, 4, STAY]  # too little energy for the diagonal
    assert mask(strict, 0.5, 1, "..", "..") == [STAY]


def test_each_agent_of_each_episode_has_its_own_mask() -> None:
    """In a row of three nodes; a scout moves two, a forager one, both as far as energy lasts."""
    graph = navigation_graph(grid("..."), 1.0, True)
    scout, forager = Role(1, 2, 1.0, False), Role(1, 1, 1.0, True)
    task = task_of(graph, MoveRules(True, False), scouts=scout, foragers=forager)
    nodes, energy = np.array([[0, 0], [1, 2]], np.int32), np.array([[9.0, 0.5], [9.0, 9.0]])
    mask = LegalMoves(task)(nodes, energy)
    found = [[np.flatnonzero(mask[e, a]).tolist() for a in (0, 1)] for e in (0, 1)]
    assert found == [[[2, STAY], [STAY]], [[STAY], [6, STAY]]]
