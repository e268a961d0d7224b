"""Policies in the forms that a user of Python has them, as names that a run knows."""

import copy
import functools
import inspect
import os
import reprlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from mjforage.api.functions import Function, policy_of_function, said_of
from mjforage.base.errors import UserError
from mjforage.base.registry import is_ours, trust
from mjforage.graph_planner.policies import create_policy
from mjforage.graph_planner.policies.registry import (
    POLICIES,
    own_weights,
    policy_class,
    policy_label,
    weights_player,
)
from mjforage.mission.policy import Policy
from mjforage.runs.sources import source_hash


class HasPredict(Protocol):
    """A loaded model of another library, such as Stable-Baselines3's."""

    @property
    def predict(self) -> Callable[..., Any]:
        """Actions for observations."""
        ...


PolicyLike = str | os.PathLike[str] | type | Policy | Function | HasPredict
Policies = PolicyLike | Iterable[PolicyLike] | Mapping[str, PolicyLike]

FORMS = (
    'a name such as "greedy", a class or an object with `reset` and `act`, a function of one view, '
    'a file "NAME.safetensors", or a model with `predict`'
)
LONGEST = 100  # letters of a name
_METHODS = ("reset", "act", "set_ground_truth", "forecast")
_HANDED = ("set_ground_truth", "parts", "libraries")
"""Attributes of a policy's class by which a run tells what it is."""


@dataclass(frozen=True)
class Players:
    """Policies by name, and the classes of those that are objects of this process.

    Attributes
    ----------
    names : references, in order
    objects : name -> class
    """

    names: tuple[str, ...] = ()
    objects: Mapping[str, type] = field(default_factory=dict)

    @classmethod
    def of(cls, policies: Any) -> "Players":
        """Policies in any form.

        Raises `UserError` if one is in no form that is known.

        `policies`: one policy, several in a list, or a dict of name -> policy.
        """
        if isinstance(policies, Mapping):
            found = [_found(one, _checked(str(name))) for name, one in policies.items()]
        else:
            several = isinstance(policies, Iterable) and not isinstance(policies, str | Path)
            found = [_found(one, "") for one in (policies if several else [policies])]
        names = [one if isinstance(one, str) else _checked(one.__name__) for one in found]
        objects = {
            name: one for name, one in zip(names, found, strict=True) if not isinstance(one, str)
        }
        return cls(tuple(names), objects)

    @contextmanager
    def known(self) -> Iterator[list[str]]:
        """Let the registry of policies find the objects by name; yields the names.

        Code that a name has is trusted from here on: to give it is the user's word. Raises
        `UserError` if a name is that of another policy.
        """
        plain = (name.partition("(")[0].strip() for name in self.names)
        trust(*(name for name in plain if ":" in name))
        with POLICIES.lent(self.objects):
            yield list(self.names)


def _found(policy: Any, name: str) -> str | type:
    """Name of a policy, or class of one that is an object."""
    if isinstance(policy, str | Path):
        return _of_text(str(policy), name)
    if inspect.iscoroutinefunction(policy):
        raise UserError(f"policy {name or policy.__name__}: is async; give a plain function")
    if inspect.isclass(policy):
        shipped = _shipped_name(policy) if not name else ""
        return shipped or _of_class(policy, name or policy.__name__)
    if callable(getattr(policy, "act", None)) and callable(getattr(policy, "reset", None)):
        return _of_object(policy, name or type(policy).__name__)
    if callable(getattr(policy, "predict", None)):
        from mjforage.api.models import policy_of_model

        return policy_of_model(policy, name or type(policy).__name__)
    if callable(policy):
        return policy_of_function(policy, name or getattr(policy, "__name__", ""))
    raise UserError(f"policy {reprlib.repr(policy)}: is {type(policy).__name__}; give {FORMS}")


def _checked(name: str) -> str:
    if not name.replace("_", "").replace("-", "").isalnum() or len(name) > LONGEST:
        remedy = 'give it a name of letters and digits, as in {"my-policy": policy}'
        raise UserError(f"policy {reprlib.repr(name)}: {remedy}")
    return name


def _of_text(text: str, name: str) -> str | type:
    if text.endswith(".zip"):
        raise UserError(
            f"policy {text}: such files hold pickles, which are code; load the model with its own "
            'class, such as MaskablePPO.load("model.zip"), and give the model'
        )
    if text.endswith(".safetensors"):
        return _of_weights(Path(text), name)
    return text if name in ("", text) else _renamed(text, name)


def _renamed(text: str, name: str) -> type:
    """The class of a named policy, options included, under another name."""
    label = policy_label(text)
    made: Any = policy_class(text)
    members = {"__new__": lambda cls: create_policy(label), "__module__": "__main__"}
    hashed = {"source_hash": label if is_ours(made) else source_hash(made, label)}
    return type(name, (), {**_handed(made), **members, **hashed, "__doc__": f"Policy {label}."})


def _of_weights(path: Path, name: str) -> str | type:
    if not path.is_file():
        raise UserError(f"policy {path}: there is no such file; train weights, or mend the path")
    name = name or path.stem
    if own_weights(name) == path.resolve():
        return name
    player, place = weights_player(), path.resolve()
    members = {"__new__": lambda cls: player(place), "__module__": "__main__"}
    return type(name, (), {**_handed(player), **members, "source_hash": "weights"})


def _of_class(made: type, name: str) -> type:
    """The class under a name, whose errors are told in a line."""
    members = {"__module__": made.__module__, "source_hash": source_hash(made)}
    guarded = {method: _guarded(getattr(made, method, None), name) for method in _METHODS}
    return type(name, (made,), members | {k: v for k, v in guarded.items() if v is not None})


def _of_object(policy: Policy, name: str) -> type:
    """Class that makes copies of an object: every batch of episodes has one of its own."""
    try:
        prototype = copy.deepcopy(policy)
    except Exception as error:
        raise UserError(
            f"policy {name}: cannot be copied ({type(error).__name__}: {error}), which every batch "
            "of episodes asks for; give its class, or let it be copied"
        ) from error
    kind = type(policy)
    made = _of_class(kind, name)

    def new(cls: type) -> Policy:
        found = copy.deepcopy(prototype)
        found.__class__ = made  # its methods tell of errors
        return found

    members = {"__new__": new, "__init__": lambda self: None, "__module__": kind.__module__}
    members |= {"__doc__": kind.__doc__}
    members |= {method: getattr(made, method) for method in ("reset", "act")}
    members["source_hash"] = source_hash(policy)
    return type(name, (), {**_handed(kind), **members})


def _guarded(method: Any, name: str) -> Any:
    """A method whose errors are a `UserError` in one line; None for no method."""
    if not callable(method):
        return None

    @functools.wraps(method)
    def guarded(*given: Any) -> Any:
        try:
            return method(*given)
        except UserError:
            raise
        except (Exception, SystemExit) as error:
            raise UserError(said_of(error, name)) from error

    return guarded


def _handed(made: Callable[..., Policy]) -> dict[str, Any]:
    return {one: getattr(made, one) for one in _HANDED if hasattr(made, one)}


def _shipped_name(made: type) -> str:
    """Name of a class of ours; "" for another."""
    names = [name for name in POLICIES.ours() if POLICIES.find(name) is made]
    return names[0] if names and is_ours(made) else ""
