"""Validation of algorithms, of users too: the parts and rows that runs and checks need."""

import logging
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from mjforage.base.errors import UserError
from mjforage.graph_planner.networks.weights import KINDS
from mjforage.learning.training.progress import Row

if TYPE_CHECKING:
    from mjforage.learning.training.algorithm import Algorithm

ALWAYS = ("rounds", "episodes", "updates", "seconds", "pta_c")  # of every round's row

logger = logging.getLogger(__name__)


def check_parts(trainer: "Algorithm[Any]") -> None:
    """Refuse networks and tensors that evaluations and checkpoints could do nothing with.

    Of a network that trains and whose weights no policy plays there is a warning. Raises
    `UserError` if a team that has agents has no network, or what is to be kept is no tensor.
    """
    import torch

    who = f"algorithm {type(trainer).__name__}"
    networks, tensors = trainer.networks, trainer.tensors()
    if not isinstance(networks, Mapping) or not isinstance(tensors, Mapping):
        raise UserError(
            f"{who}: networks and tensors() are {type(networks).__name__} and "
            f"{type(tensors).__name__}; make both a dict"
        )
    for team, ids in trainer.agents.items():
        made = networks.get(team)
        if ids.size and not isinstance(made, torch.nn.Module):
            was = "nothing" if made is None else f"a {type(made).__name__}"
            raise UserError(
                f"{who}: networks has {was} for {team}, which has agents; give every such team "
                "a module"
            )
    _tell_of_other_networks(trainer)
    for name, value in tensors.items():
        if not isinstance(value, torch.Tensor):
            raise UserError(
                f"{who}: tensors() has a {type(value).__name__} in {name}; make it a torch.Tensor"
            )


def _tell_of_other_networks(trainer: "Algorithm[Any]") -> None:
    from mjforage.graph_planner.networks import q_network

    classes = {kind: getattr(q_network, name) for kind, name in KINDS.items()}
    wanted = classes[trainer.weights_kind]
    others = {type(made) for made in trainer.networks.values()} - {wanted}
    if not others:
        return
    kinds = [kind for kind, made in classes.items() if others == {made}]
    remedy = f"give weights_kind = {kinds[0]!r}" if kinds else "play them by a ModelPolicy"
    names = ", ".join(sorted(made.__name__ for made in others))
    logger.warning(
        "algorithm %s: its networks are of %s; they train, but by weights_kind %r only weights "
        "of %s are a policy by the name of their file: %s",
        *(type(trainer).__name__, names, trainer.weights_kind, wanted.__name__, remedy),
    )


def checked_row(trainer: "Algorithm[Any]", row: Any) -> Row:
    """The row that `play_round` gave, if it is valid.

    Raises `UserError` if it is none: nothing, without what `end_round` gives or with other counts,
    or with what is no number.
    """
    who, given = f"algorithm {type(trainer).__name__}: play_round gave", "self.end_round gives"
    if not isinstance(row, Mapping):
        raise UserError(f"{who} {type(row).__name__}; return what {given}")
    lacking = [name for name in ALWAYS if name not in row]
    if lacking:
        raise UserError(f"{who} a row without {', '.join(lacking)}; return what {given}")
    for name, value in row.items():
        if not isinstance(value, int | float | np.number):
            raise UserError(f"{who} {name} = {value!r:.40}; a row has numbers")
    for name, count in trainer.come("rounds", "updates").items():
        if row[name] != count:
            raise UserError(
                f"{who} {name} = {row[name]:g} where self.progress has {count:g}; return what "
                f"{given}"
            )
    return dict(row)
