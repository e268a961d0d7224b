"""A policy of a plain function of one episode: moves of agents by their names."""

import inspect
from collections.abc import Callable, Mapping
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mjforage.api import checks
from mjforage.api.view import View
from mjforage.base.errors import UserError
from mjforage.base.randomness import UInt64Array
from mjforage.base.references import nearest
from mjforage.base.registry import fault
from mjforage.graph_planner.encodings import LegalMoves
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.mission.moves import CHOSEN, OTHERWISE_STAY
from mjforage.mission.plain import Plain
from mjforage.mission.task import Observation, Task
from mjforage.runs.sources import source_hash

Move = str | int | None
Function = Callable[[View], Mapping[str, Move] | None]


class FunctionPolicy:
    """Base of the policies of plain functions; a subclass has its function."""

    function: ClassVar[Function]
    source_hash: ClassVar[str]

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._task, self._plain, self._legal = task, Plain(task, keys.size), LegalMoves(task)
        self._preferences = np.zeros((keys.size, len(task.fleet), 9))

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9); raises `UserError` if the function gives no moves."""
        observation = self._plain(observation)
        self._preferences[..., :STAY], self._preferences[..., STAY] = 0.0, OTHERWISE_STAY
        legal = self._legal(observation.agent_node, observation.energy_left)
        for row in np.flatnonzero(observation.active).tolist():
            for agent, move in self._ask(View(self._task, observation, row, legal[row])):
                self._preferences[row, agent, move] = CHOSEN
        return self._preferences

    def _ask(self, view: View) -> list[tuple[int, int]]:
        """Agent and move of each answer of the function."""
        name = type(self).__name__
        try:
            answer = type(self).function(view)
        except UserError as error:
            raise UserError(f"policy {name}: {error}") from error
        except (Exception, SystemExit) as error:
            raise UserError(said_of(error, name)) from error
        if answer is None:
            return []
        if not isinstance(answer, Mapping):
            raise UserError(
                f"policy {name}: gave {type(answer).__name__}; give a dict of agent -> move, such "
                f'as {{"{view.agents[0]}": "N"}}'
            )
        moves = []
        for agent, move in answer.items():
            if agent not in view.agents:
                close = nearest(str(agent), view.agents)
                raise UserError(f"policy {name}: gave a move for {agent!r}, no agent; {close}")
            if move is not None:
                number = checks.move_number(move, f"policy {name}", agent)
                moves.append((view.agents.index(agent), number))
        return moves


def said_of(error: BaseException, name: str) -> str:
    """Line about an error that a user's policy raised."""
    return " ".join(f"policy {name}: raised {fault(error)}; mend it".split())


def policy_of_function(function: Function, name: str) -> type[FunctionPolicy]:
    """Class of a policy that asks a function."""
    members = {
        "__module__": getattr(function, "__module__", None) or "__main__",
        "__doc__": inspect.getdoc(function) or "Plain function.",
        "function": staticmethod(function),
        "source_hash": source_hash(function),
    }
    return type(name, (FunctionPolicy,), members)
