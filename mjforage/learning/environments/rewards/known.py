"""Registry of terms: ours, those of installed packages, and any by `package.module:Class`."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from mjforage.base.device import Bind, Call
from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.base.registry import Registry, built, is_ours
from mjforage.base.views import CachedViews
from mjforage.graph_planner.graph.geodesics import Workspace
from mjforage.learning.environments.rewards.term import (
    COPY,
    Amounts,
    Before,
    DeviceStep,
    DeviceTerm,
    Step,
    Term,
)
from mjforage.mission.dynamics import Transition
from mjforage.mission.ledger import Ledger
from mjforage.mission.mission import Mission
from mjforage.mission.task import Task

REWARDS: Registry[Callable[..., Term]] = Registry("reward", "mjforage.rewards")

reward = REWARDS.register
"""Class decorator that makes a term known under a name, as `Registry.register`."""


def term_class(text: str) -> Callable[..., Term]:
    """The class that a reference names.

    Raises `UserError` if there is none, an option does not fit, or it is no class of terms.
    """
    _, made, _ = REWARDS.bound(text)
    if not isinstance(made, type) or not any("__call__" in vars(base) for base in made.__mro__):
        raise UserError(f"reward {text}: is no term; give a class with __call__(self, step)")
    return made


def create_term(text: str) -> Term:
    """A fresh term.

    Raises `UserError` as `term_class`; a `ValueError` of its `__init__` becomes part of it.

    `text`: NAME or `package.module:Class`, with options in parentheses.
    """
    return built(f"reward {text}", term_class(text), **REWARDS.bound(text)[2])


class RewardTerms:
    """Computes the chosen terms of a batch at every step."""

    def __init__(self, task: Task, names: Iterable[str], turns: int = 1) -> None:
        """Prepare.

        Raises `UserError` as `create_term`.

        Parameters
        ----------
        names : references to terms
        turns : steps of the environment in one of the mission, see `Step`
        """
        self._task, self._workspace, self._turns = task, Workspace.of(len(task.graph)), turns
        self._copy: Before | None = None
        self._views = CachedViews[Before]()
        self._terms = {name: create_term(name) for name in names}
        self._theirs = {name for name, term in self._terms.items() if not is_ours(type(term))}

    def before(self, mission: Mission) -> Before:
        """Copy the state that the next one is compared with; call before every step."""
        live, copied = Before.of(mission), self._copy
        arrays: tuple[NDArray[Any], ...] = live
        if copied is None or [one.shape for one in copied] != [one.shape for one in arrays]:
            self._copy = copied = Before._make(np.empty_like(each) for each in arrays)
        own: tuple[NDArray[Any], ...] = copied
        for mine, theirs in zip(own, arrays, strict=True):
            np.copyto(mine, theirs)
        self._before = self._views.of(copied)
        return self._before

    @property
    def on_host_only(self) -> list[str]:
        """Terms that no device computes: those of others, whatever they inherit."""
        return sorted(self._theirs)

    def on_device(
        self, bind: Bind, state: Transition, ledger: Ledger, after: Before
    ) -> tuple[Call, tuple[Call, ...], dict[str, Amounts]]:
        """`before` and `after` by kernels on a device, of live arrays, and what these write."""
        copied = Before._make(np.zeros(part.shape, part.dtype) for part in after)
        about = state, ledger, self._task, self._workspace, self._turns
        step, calls = DeviceStep(copied, after, *about), list[Call]()
        found = {name: np.zeros(state.agent_node.shape) for name in self._terms}
        for name, term in self._terms.items():
            calls += cast(DeviceTerm, term).on_device(bind, step, found[name])
        return bind(COPY, after, copied), tuple(calls), found

    def after(self, mission: Mission, played: NDArray[np.bool_]) -> dict[str, Amounts]:
        """Terms of the step just made: name -> (episode, agent), 0 for episodes not played.

        Raises `UserError` if a term of a user gives an array of another shape, or a number that is
        not finite.
        """
        step = Step(mission, self._before, self._task, self._workspace, self._turns)
        found = {name: term(step) for name, term in self._terms.items()}
        for name in self._theirs:
            found[name] = _sound(name, found[name], step)
        if played.all():
            return found
        return {name: np.where(played[:, None], value, 0.0) for name, value in found.items()}


def _sound(name: str, found: Any, step: Step) -> Amounts:
    """The numbers of a term, of the shape that they must have, and all finite."""
    amounts = np.asarray(found, np.float64)
    shape = step.mission.state.agent_node.shape
    if amounts.shape != shape:
        raise UserError(
            f"reward {name}: gave an array of shape {amounts.shape}; give (episode, agent), "
            f"here {shape}"
        )
    if not np.isfinite(amounts).all():
        raise UserError(f"reward {name}: gave a number that is not finite; mend the term")
    return amounts


def checked_weights(weights: Mapping[str, float]) -> dict[str, float]:
    """The weights that are not 0, each by the one spelling of its term.

    Raises `UserError` if a term is not known or is given twice, or a weight is no finite number.
    """
    return {name: weight for name, weight in labelled(weights).items() if weight}


def labelled(weights: Mapping[str, float]) -> dict[str, float]:
    """All weights, each by the one spelling of its term; raises as `checked_weights`."""
    if not isinstance(weights, Mapping):
        raise UserError(f"reward = {weights!r}: give a weight for each term, as {{'removed': 1.0}}")
    found: dict[str, float] = {}
    for text, weight in weights.items():
        if not isinstance(text, str):
            raise UserError(f"reward {text!r}: is {type(text).__name__}; give the name of a term")
        term_class(text)
        name = str(REWARDS.bound(text)[0])
        if name in found:
            raise UserError(f"reward {name}: given twice; give it one weight")
        found[name] = finite(name, weight)
    return found


def checked_names(weights: Mapping[str, float], known: Iterable[str]) -> dict[str, float]:
    """The weights that are not 0, all of known terms; raises `UserError` as above."""
    names = list(known)
    for name in weights:
        if name not in names:
            raise UserError(f"reward {name}: unknown; {nearest(name, names)}")
    return {name: finite(name, weight) for name, weight in weights.items() if weight}


def finite(name: str, weight: float) -> float:
    """A weight. Raises `UserError` if it is no finite number."""
    number = isinstance(weight, int | float | np.number) and not isinstance(weight, bool)
    if not number or not np.isfinite(weight):
        raise UserError(f"reward {name} = {weight!r}: give a finite number")
    return float(weight)
