import numpy as np

from graph_planner.encodings import legal_moves
from graph_planner.fleet import Role
from graph_planner.moves import MoveRules
from graph_planner.navigation import STAY, navigation_graph
from tests.graph_planner.charts import grid
from tests.graph_planner.driver import task_of


def mask(rules: MoveRules, energy: float, moves: int = 1, *rows: str) -> list[int]:
    graph = navigation_graph(grid(*rows), 1.0, True)
    task = task_of(graph, rules, scouts=Role(1, moves, 1.0, False))
    return np.flatnonzero(
        legal_moves(task, np.zeros((1, 1), np.int32), np.full((1, 1), energy))[0, 0]
    ).tolist()


def test_land_rules_and_energy_decide() -> None:
    free, strict = MoveRules(True, True), MoveRules(False, False)
    assert mask(free, np.inf, 1, "..", "..") == [2, 3, 4, STAY]
    assert mask(strict, np.inf, 1, "..", "..") == [2, 3, 4]
    assert mask(strict, np.inf, 2, "..", "..") == [STAY]  # nothing is legal: it stays, blocked
    assert mask(free, 1.2, 1, "..", "..") == [2, 4, STAY]  # too little energy for the diagonal
    assert mask(strict, 0.5, 1, "..", "..") == [STAY]
