"""What a policy is, and the table of those that exist."""

import difflib
import logging
from collections.abc import Callable
from pathlib import Path
from typing import Protocol, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from graph_planner.randomness import UInt64Array
from graph_planner.task import Observation, Task, Truth


class Policy(Protocol):
    """Decides for the whole fleet, batched over episodes."""

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
class Bound(Policy, Protocol):
    """A policy that is shown the truth: no policy to compare with, but a bound on what is possible.

    Every table marks it as a bound.
    """

    def reveal(self, truth: Truth) -> None:
        """Take in where the items are, before every `act`."""
        ...


PolicyClass = TypeVar("PolicyClass", bound=Callable[[], Policy])
_POLICIES: dict[str, Callable[[], Policy]] = {}
_logger = logging.getLogger(__name__)


def register(name: str) -> Callable[[PolicyClass], PolicyClass]:
    """Class decorator that makes a policy known under a name.

    Raises
    ------
    ValueError
        If the name is taken.
    """

    def add(policy: PolicyClass) -> PolicyClass:
        if name in _POLICIES:
            raise ValueError(f"policy {name!r} is registered already")
        _POLICIES[name] = policy
        return policy

    return add


def policy_names() -> list[str]:
    """All registered names, sorted."""
    return sorted(_POLICIES)


def own_weights(name: str) -> Path | None:
    """`NAME.safetensors` of the present folder, if no registered policy has that name."""
    path = Path(f"{name}.safetensors")
    own = name not in _POLICIES and path.name == str(path) and path.is_file()
    return path.resolve() if own else None


def weights_of(name: str) -> Path | None:
    """The weights that a policy reads, its own or shipped; None for a policy without.

    A warning is logged if the present folder has a file of that name which is not read.
    """
    read = own_weights(name)
    shipped = getattr(_POLICIES.get(name), "weights", None)
    if shipped is not None:
        from graph_planner.weights import shipped_weights

        read = shipped_weights(shipped)
    there = Path(f"{name}.safetensors")
    if there.is_file() and not (read and read.exists() and there.samefile(read)):
        _logger.warning(
            "policy %s is the one that ships; %s in the present folder is not read: rename it, and "
            "its policy has the new name",
            name,
            there,
        )
    return read


def create_policy(name: str) -> Policy:
    """A fresh policy: a registered one, or the weights `NAME.safetensors` of the present folder.

    Raises
    ------
    KeyError
        If there is none of that name; the message offers the nearest.
    WeightsError
        If the present folder has such a file, but no weights of ours are in it.
    """
    weights = own_weights(name)
    if weights is not None:
        from graph_planner.policies.ddqn import QPolicy  # it registers policies itself

        return QPolicy(weights)
    if name not in _POLICIES:
        close = difflib.get_close_matches(name, _POLICIES, n=1)
        hint = f"did you mean {close[0]}?" if close else f"choose {', '.join(policy_names())}"
        raise KeyError(f"policy {name}: unknown; {hint}")
    return _POLICIES[name]()


def policy_summary(name: str) -> str:
    """First line of a policy's docstring."""
    return (_POLICIES[name].__doc__ or "").strip().splitlines()[0]


def is_bound(name: str) -> bool:
    """Whether the policy of a name is shown the truth; unknown names are not."""
    return hasattr(_POLICIES.get(name), "reveal")
