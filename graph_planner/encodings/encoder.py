"""Interface and registry of observation encoders, levels, and trails."""

from collections.abc import Callable
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.device import Bind, Call
from mjforage.base.errors import UserError
from mjforage.base.registry import Registry, built
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.task import Observation, Task

Levels: TypeAlias = NDArray[np.uint8]
Shapes: TypeAlias = dict[str, tuple[int, ...]]

TRAIL = 10
"""Positions in an agent's trail, the present one included (paper: a trail of 10)."""
MOST_ITEMS = 10
"""Believed items of a node at which its level is full."""
TOP = 255


class Encoder(Protocol):
    """Pictures of what the fleet knows, one set per agent.

    Its class is called with the task, and the options of a reference as keywords. A class whose
    pictures are of no use on another map says `map_bound = True`.
    """

    @property
    def shapes(self) -> Shapes:
        """Name -> shape of one agent's array."""
        ...

    def reset(self, episodes: int) -> None:
        """Forget everything; get ready for a batch of so many episodes."""
        ...

    def see(self, seen: Observation, rows: NDArray[np.int64]) -> dict[str, Levels]:
        """Look at the episodes `rows` of the batch; the first decision of one clears its memory.

        Returns: name -> `(episode, agent, *shape)` uint8; live arrays, in which other episodes keep
        what they had. Looking twice at one step changes nothing.
        """
        ...


class DeviceEncoder(Encoder, Protocol):
    """An encoder that a device can run as well.

    Attributes
    ----------
    fits_a_device : whether it can on this map
    """

    fits_a_device: bool

    def on_device(
        self, bind: Bind, ids: NDArray[np.bool_], seen: Observation
    ) -> tuple[Call, dict[str, Levels]]:
        """`see` of the rows that a mask (row,) then has, by a kernel, and the arrays it fills."""
        ...


ENCODERS: Registry[Callable[..., Encoder]] = Registry(
    "observation", "mjforage.observations", given=1
)


encoder = ENCODERS.register
"""Class decorator that makes an encoder known under a name, as `Registry.register`."""


def encoder_class(text: str) -> Callable[..., Encoder]:
    """The class that a reference names.

    Raises `UserError` if there is none, an option does not fit, or it is no class of encoders.
    """
    _, made, _ = ENCODERS.bound(text)
    missing = [name for name in ("reset", "see") if not callable(getattr(made, name, None))]
    if missing or not isinstance(made, type):
        raise UserError(
            f"observation {text}: is no encoder; give a class with shapes, reset and see"
        )
    return made


def encoder_label(text: str) -> str:
    """The one spelling of a reference to an encoder; raises as `encoder_class`."""
    if not isinstance(text, str):
        raise UserError(f"observation = {text!r}: give a name, such as egocentric")
    encoder_class(text)
    return str(ENCODERS.bound(text)[0])


def create_encoder(text: str, task: Task) -> Encoder:
    """A fresh encoder.

    Raises `UserError` as `encoder_class`, and if its shapes are not valid; the message of a
    `ValueError` of its `__init__` becomes part of it.

    Parameters
    ----------
    text : NAME or `package.module:Class`, with options in parentheses
    task : map, fleet and rules that it is for
    """
    options = ENCODERS.bound(text)[2]
    made = built(f"observation {text}", encoder_class(text), task, **options)
    shapes = getattr(made, "shapes", None)
    if not isinstance(shapes, dict) or not all(map(_is_shape, shapes.values())) or not shapes:
        raise UserError(
            f"observation {text}: shapes = {shapes!r:.60}; give a dict of names and tuples of "
            "whole numbers, at least one"
        )
    return made


def _is_shape(value: object) -> bool:
    return isinstance(value, tuple) and all(type(n) is int and n > 0 for n in value)


@inlined
def item_level(items: int) -> int:
    """Level of a number of believed items."""
    return min(items, MOST_ITEMS) * TOP // MOST_ITEMS


@kernel
def remember_places(
    rows: NDArray[np.int64],
    step: Int32Array,
    agent_node: Int32Array,
    seen_at: Int32Array,
    trail: Int32Array,
) -> None:
    """Append the present nodes to the trails, newest first, once per step.

    Parameters
    ----------
    rows : (row,) episodes
    step : (episode,) the decision about to be taken
    seen_at : (episode,) step of the last look; written
    trail : (episode, agent, TRAIL) nodes, -1 for none; written
    """
    for e in rows:
        if step[e] <= 1:
            trail[e] = -1
        elif seen_at[e] == step[e]:
            continue
        seen_at[e] = step[e]
        for a in range(agent_node.shape[1]):
            for k in range(TRAIL - 1, 0, -1):
                trail[e, a, k] = trail[e, a, k - 1]
            trail[e, a, 0] = agent_node[e, a]


@inlined
def trail_level(age: int) -> int:
    """Level of a trail's node, `age` steps old: full where the agent is, then fading."""
    return TOP * (TRAIL - age) // TRAIL
