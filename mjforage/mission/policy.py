"""The protocol of policies."""

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.mission.task import GroundTruth, Observation, Task


class Policy(Protocol):
    """Decides for the whole fleet, batched over episodes.

    Its class is called without arguments, or with the options of a reference as keywords. A policy
    whose moves hang on files names them in an attribute `files`, a tuple of paths: what is in them
    is then part of what a run is. So is the source of the classes in an attribute `parts`, a tuple
    of those that it finds by their names, such as an observation encoder. A text in an attribute
    `told` says in tables what it knows of the items before an episode.
    """

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Forget everything and get ready for a batch of episodes.

        Parameters
        ----------
        task : map, fleet, rules and horizon
        keys : (episode,) episode keys
        """
        ...

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9): 0-7 compass moves from north clockwise, 8 stay.

        The resolver takes each agent's largest legal one. No NaN; rows of inactive episodes are
        ignored.
        """
        ...


@runtime_checkable
class UpperBound(Policy, Protocol):
    """An oracle upper bound: it gets the ground truth, and bounds what policies can reach.

    Every table marks it as a bound. It decides by what the fleet knows together, once for each
    episode; with a true attribute `decentralised` it decides for each belief owner, as policies do.
    """

    def set_ground_truth(self, truth: GroundTruth) -> None:
        """Take in where the items are, before every `act`, in the rows of its observation."""
        ...
