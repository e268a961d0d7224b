"""What a learner sees of an `Observation`: pictures of the map per agent, as levels of 0 to 255.

Kinds are named in `ENCODERS`; each turns the fleet's observation into arrays of
(episode, agent, ...) uint8, where level / 255 is the value in [0, 1]. Policies and environments
share them, so a network sees the same bytes when it is trained and when it is used.
"""

from collections.abc import Callable

from graph_planner.encodings.egocentric import Egocentric
from graph_planner.encodings.encoder import Encoder, Shapes
from graph_planner.encodings.masks import legal_moves
from graph_planner.encodings.paper_channels import PaperChannels
from graph_planner.task import Task

ENCODERS: dict[str, Callable[[Task], Encoder]] = {
    "paper": PaperChannels,
    "egocentric": Egocentric,
}

__all__ = ["ENCODERS", "Egocentric", "Encoder", "PaperChannels", "Shapes", "legal_moves"]
