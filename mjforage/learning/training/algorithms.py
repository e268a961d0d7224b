"""The training algorithms by name, ours and `package.module:Class` of a user."""

from typing import Any

from mjforage.base.errors import UserError
from mjforage.base.registry import Registry
from mjforage.graph_planner.networks.weights import KINDS
from mjforage.learning.training.algorithm import Algorithm
from mjforage.learning.training.mappo.trainer import MappoTrainer
from mjforage.learning.training.trainer import Trainer

ALGORITHMS: Registry[type[Algorithm[Any]]] = Registry("algorithm", "mjforage.algorithms")
"""Subclasses of `Algorithm`; installed packages bring theirs by entry points."""

TO_WRITE = ("networks", "play_round", "tensors", "restore")
"""Methods that a subclass of `Algorithm` brings."""

ALGORITHMS.register("ddqn")(Trainer)
ALGORITHMS.register("mappo")(MappoTrainer)


def find_algorithm(name: str) -> type[Algorithm[Any]]:
    """The class of an algorithm.

    Raises `UserError` if there is none of that name (the message offers the nearest), it cannot be
    imported, or it is no `Algorithm` with `settings`, a `weights_kind` that policies play and all
    of `TO_WRITE`.

    `name`: ddqn, mappo, a name of an installed package, or `package.module:Class`.
    """
    found = ALGORITHMS.find(name)
    if not (
        isinstance(found, type) and issubclass(found, Algorithm) and hasattr(found, "settings")
    ):
        raise UserError(
            f"algorithm {name}: is no mjforage.learning.training.algorithm.Algorithm with "
            "settings; make it a subclass"
        )
    if found.weights_kind not in KINDS:
        raise UserError(
            f"algorithm {name}: weights_kind {found.weights_kind!r}: no policy plays it; give "
            f"{' or '.join(f'{kind!r} ({made})' for kind, made in KINDS.items())}"
        )
    lacking = [one for one in TO_WRITE if getattr(found, one) is getattr(Algorithm, one)]
    if lacking:
        raise UserError(f"algorithm {name}: has no {', '.join(lacking)}; write it")
    return found
