"""Weights that a training begins with: those of a policy, or of any file that `train` wrote."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from torch.nn import Module

from mjforage.base.errors import UserError
from mjforage.graph_planner.encodings import encoder_label
from mjforage.graph_planner.networks.weights import load_networks, read_header
from mjforage.graph_planner.policies.registry import policy_files
from mjforage.learning.training.hyperparameters import CommonHyperparameters
from mjforage.mission.task import Task

SUFFIX = ".safetensors"


def initial_file(reference: str) -> Path:
    """The one weight file that a policy plays, or the file that is named.

    Raises `UserError` if the policy is not known, or plays no such file.
    """
    if reference.endswith(SUFFIX):
        return Path(reference)
    files = policy_files(reference)
    if len(files) != 1 or files[0].suffix != SUFFIX:
        raise UserError(
            f"initial weights {reference}: is a policy that plays none; give one that does, such "
            f"as ddqn, or FILE{SUFFIX}"
        )
    return files[0]


def begin_with(
    modules: Mapping[str, Sequence[Module]], settings: CommonHyperparameters, task: Task, kind: str
) -> None:
    """Give networks the weights that are named; optimisers are new.

    Raises `UserError` if they are of another kind or observation, or not what the policies that
    play them would take: see `load_networks`.

    Parameters
    ----------
    modules : team -> its networks
    kind : of the weight files that the algorithm writes, in `networks.weights.KINDS`
    """
    path = initial_file(settings.initial)
    header = read_header(path)
    if header.format != kind:
        raise UserError(
            f"initial weights {settings.initial}: are of the kind {header.format}, but this "
            f"algorithm trains {kind}; give others"
        )
    encoding = encoder_label(header.encoding)
    if encoding != settings.observation:
        raise UserError(
            f"initial weights {settings.initial}: are of the {encoding} observation, but this "
            f"training has {settings.observation}; give observation = {encoding}, or other weights"
        )
    networks = load_networks(path, task)
    for team, own in modules.items():
        for module in own:
            module.load_state_dict(networks[team].state_dict())
