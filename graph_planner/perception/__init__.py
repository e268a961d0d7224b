"""What a learner sees of an `Observation`: pictures of the map per agent, as levels of 0 to 255.

Kinds are named in `PERCEPTIONS`; each turns the fleet's observation into arrays of
(episode, agent, ...) uint8, where level / 255 is the value in [0, 1]. Policies and environments
share them, so a network sees the same bytes when it is trained and when it is used.
"""

from collections.abc import Callable

from graph_planner.perception.base import Perception, Shapes
from graph_planner.perception.egocentric import Egocentric
from graph_planner.perception.masks import legal_moves
from graph_planner.perception.paper import PaperChannels
from graph_planner.task import Task

PERCEPTIONS: dict[str, Callable[[Task], Perception]] = {
    "paper": PaperChannels,
    "egocentric": Egocentric,
}

__all__ = ["PERCEPTIONS", "Egocentric", "PaperChannels", "Perception", "Shapes", "legal_moves"]
