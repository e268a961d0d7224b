"""Weights that a training begins with: those of a policy, or of any file that `train` wrote."""

from collections.abc import Mapping
from pathlib import Path

from torch.nn import Module

from graph_planner.encodings import encoder_label
from graph_planner.policies.registry import policy_files
from graph_planner.task import Task
from graph_planner.weights import load_networks, read_header
from mjforage.core.errors import UserError
from mjforage.learning.training.hyperparameters import Hyperparameters
from mjforage.learning.training.learner import Learner

SUFFIX = ".safetensors"


def initial_file(reference: str) -> Path:
    """The one weight file that a policy plays, or the file that is named.

    Raises
    ------
    UserError
        If the policy is not known, or plays no such file.
    """
    if reference.endswith(SUFFIX):
        return Path(reference)
    files = policy_files(reference)
    if len(files) != 1 or files[0].suffix != SUFFIX:
        raise UserError(
            f"--from {reference}: plays no weights; give a policy that does, such as ddqn, or "
            f"FILE{SUFFIX}"
        )
    return files[0]


def begin_with(learners: Mapping[str, Learner], told: Hyperparameters, task: Task) -> None:
    """Give every network of the learners (team,) the weights that are named; optimisers are new.

    Raises
    ------
    UserError
        If they are of another observation, or not what the policies that play them would take:
        see `load_networks`.
    """
    path = initial_file(told.initial)
    encoding = encoder_label(read_header(path).encoding)
    if encoding != told.observation:
        raise UserError(
            f"--from {told.initial}: weights of the {encoding} observation, but this training has "
            f"{told.observation}; give --learning observation={encoding}, or other weights"
        )
    networks = load_networks(path, task)
    for team, learner in learners.items():
        for part in vars(learner).values():
            if isinstance(part, Module):
                part.load_state_dict(networks[team].state_dict())
