"""A channel one node wide, in which what a move is worth is known in closed form.

Two foragers far apart go east or west: no other move is legal. Moves cost an agent its number from
1, twice that if they lead the wrong way. In some episodes their energy is for two moves, after
which the task is at its end; the others last to the horizon, beyond which they would go on.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.encodings import LegalMoves
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.learning.environments.rewards import Amounts, Step
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.mission.task import Observation, Task
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario

GAMMA, HORIZON, EAST, WEST = 0.5, 6, 2, 6
RIGHT = (WEST, EAST)  # the cheap move of each agent
ENDING, LASTING = 2.0, 1000.0  # energy [node]
FIRST, SECOND, ANY = 0, 1, 2  # a picture: two moves left, one, or no end in sight
PLACE, WHERE, TOLL, TEACHER = (
    f"{__name__}:{name}" for name in ("Place", "Where", "Toll", "Eastward")
)
SETTINGS: dict[str, object] = {
    "num_envs": 2,
    "gamma": GAMMA,
    "observation": PLACE,
    "reward": {TOLL: -1.0},
    "vary.team.foragers.energy": [ENDING, LASTING],
    "evaluate_episodes": 1,
}
PICTURES = np.eye(6, dtype=np.uint8) * 255  # agent 0 with FIRST, SECOND, ANY, then agent 1


class Place:
    """One of the six pictures."""

    def __init__(self, task: Task) -> None:
        self._agents = len(task.fleet)

    @property
    def shapes(self) -> dict[str, tuple[int, ...]]:
        return {"x": (6,)}

    def reset(self, episodes: int) -> None:
        self._out = np.zeros((episodes, self._agents, 6), np.uint8)

    def see(self, seen: Observation, rows: NDArray[np.int64]) -> dict[str, NDArray[np.uint8]]:
        kind = np.select([seen.energy_left == 2.0, seen.energy_left == 1.0], [FIRST, SECOND], ANY)
        self._out[rows] = PICTURES[3 * np.arange(self._agents) + kind[rows]]
        return {"x": self._out}


class Toll:
    """The number of the agent, from 1; twice that the wrong way."""

    def __call__(self, step: Step) -> Amounts:
        assert step.mission.moves is not None
        wrong = step.mission.moves.direction != np.array(RIGHT)
        return np.asarray(np.array([1.0, 2.0]) * (1.0 + wrong), np.float64)


def channel(folder: Path) -> Scenario:
    """The scenario; its map is put into a folder."""
    path = folder / "channel.csv"
    path.write_text(",".join(["1"] * 60) + "\n", "utf-8")
    values = (
        *(f"horizon={HORIZON}", f"map.file='{path}'", "map.starts=[[0, 20], [0, 40]]"),
        *("team.scouts.count=0", "team.foragers.count=2", "rules.stay=false"),
        *("items.mean=40", "items.std=0", "items.covariance_node2=10000"),
    )
    return load_scenario("comb-port", values)


class Where:
    """Row, column, decision and number of each agent, as levels."""

    def __init__(self, task: Task) -> None:
        self._task = task

    @property
    def shapes(self) -> dict[str, tuple[int, ...]]:
        return {"x": (4,)}

    def reset(self, episodes: int) -> None:
        self._out = np.zeros((episodes, len(self._task.fleet), 4), np.uint8)

    def see(self, seen: Observation, rows: NDArray[np.int64]) -> dict[str, NDArray[np.uint8]]:
        graph, at = self._task.graph, seen.agent_node
        numbers = np.broadcast_to(np.arange(at.shape[1]), at.shape)
        step = np.broadcast_to(seen.step[:, None], at.shape)
        found = np.stack((graph.rows[at], graph.cols[at], step, numbers), axis=-1)
        self._out[rows] = found[rows]
        return {"x": self._out}


class Eastward:
    """A teacher who would go east."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        self._shape = keys.size, len(task.fleet), 9

    def act(self, seen: Observation) -> NDArray[np.float64]:
        preferences = np.zeros(self._shape)
        preferences[..., EAST] = 1.0
        return preferences


def pond(folder: Path, items: int = 3) -> Scenario:
    """Two scouts and two foragers in open water of 4 x 5 nodes, with so many items."""
    path = folder / "pond.csv"
    path.write_text("\n".join([",".join("1" * 5)] * 4) + "\n", "utf-8")
    values = (
        *("horizon=9", f"map.file='{path}'", "map.starts=[[0, 0], [0, 4], [3, 0], [3, 4]]"),
        *(
            f"items.mean={items}",
            "items.std=0",
            "items.covariance_node2=1",
            "team.foragers.moves=2",
        ),
    )
    return load_scenario("comb-port", values)


@dataclass(frozen=True)
class Again:
    """An episode of one environment that is played once more by its moves, step by step.

    Attributes
    ----------
    seen : (step, agent, 4) of `Where`, the last after the last move
    legal : (step, agent, 9) likewise
    made : (step, agent) moves; staying where a move was not legal, or its node taken
    removed : (step, agent) items
    over : whether no item was left in the end
    """

    seen: NDArray[np.uint8]
    legal: NDArray[np.bool_]
    made: NDArray[np.int8]
    removed: NDArray[np.int64]
    over: bool


def again(scenario: Scenario, key: NDArray[np.uint64], moves: NDArray[np.int64]) -> Again:
    """Play moves (step, agent) in a mission of their own; those behind its end do not count."""
    mission = Mission(Setup.of(scenario))
    mission.start(key)
    agents, encoder = len(mission.setup.fleet), Where(mission.task)
    encoder.reset(1)
    seen, legal, made = [], [], []
    removed: list[NDArray[np.int64]] = []

    def look() -> None:
        seen.append(encoder.see(mission.observation, np.zeros(1, np.int64))["x"][0].copy())
        at, energy = mission.knowledge.agent_node, mission.knowledge.energy_left
        legal.append(LegalMoves(mission.task)(at, energy)[0])

    look()
    while mission.active[0]:
        before = mission.state.collected_by[0].copy()
        mission.advance((2.0 * np.eye(9)[moves[len(removed)]] + np.eye(9)[STAY])[None])
        assert mission.moves is not None
        made.append(mission.moves.direction[0].copy())
        new = mission.state.collected_by[0][mission.state.collected_by[0] != before]
        removed.append(np.bincount(new[new >= 0], minlength=agents))
        look()
    over = not (mission.state.item_node >= 0).any()
    return Again(np.array(seen), np.array(legal), np.array(made), np.array(removed), over)
