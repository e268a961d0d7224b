"""Safetensors files of training: whole or absent, and equal bytes for equal content; what of an
optimiser is in them.
"""

from collections.abc import Mapping
from pathlib import Path

import torch
from safetensors import SafetensorError
from safetensors.torch import save_file
from torch import Tensor, nn
from torch.optim import Adam

from mjforage.base.atomic_files import atomic_write


def save_tensors(path: Path, tensors: Mapping[str, Tensor], note: tuple[str, str]) -> None:
    """Write tensors through a temporary file.

    Raises `UserError` if the file cannot be written.

    `note`: key and text for the header; one only, as safetensors puts several in any order.
    """
    with atomic_write(path, SafetensorError) as beside:
        save_file(dict(tensors), beside, metadata=dict([note]))
        beside.chmod(0o644)  # safetensors leaves it to the owner alone


def count_of(tensor: Tensor) -> int:
    """A count that a file holds. Raises `ValueError` if it is none."""
    if (count := int(tensor)) < 0:
        raise ValueError(f"a count is {count}")
    return count


def part_of(state: Mapping[str, Tensor], name: str) -> dict[str, Tensor]:
    """The entries "NAME.KEY" of a state, by their keys."""
    start = f"{name}."
    return {k.removeprefix(start): v for k, v in state.items() if k.startswith(start)}


def learner_state(
    modules: Mapping[str, nn.Module], optimiser: Adam, updates: int
) -> dict[str, Tensor]:
    """Modules by name, their optimiser and its count of updates, for a checkpoint."""
    state = {"updates": torch.tensor(updates)}
    for name, module in modules.items():
        state |= {f"{name}.{key}": value for key, value in module.state_dict().items()}
    for i, moments in optimiser.state_dict()["state"].items():
        state |= {f"optimiser.{i}.{key}": value for key, value in moments.items()}
    return {name: value.detach().cpu().contiguous() for name, value in state.items()}


def restore_learner(
    modules: Mapping[str, nn.Module], optimiser: Adam, state: Mapping[str, Tensor]
) -> int:
    """Restore the state that `learner_state` gave; returns the count of updates.

    Raises `ValueError` if it is not of such modules.
    """
    for name, module in modules.items():
        module.load_state_dict(part_of(state, name))
    _restore_moments(optimiser, part_of(state, "optimiser"))
    return count_of(state["updates"])


def _restore_moments(optimiser: Adam, state: Mapping[str, Tensor]) -> None:
    """Give an optimiser back its moments.

    Raises `ValueError` if they are not of its parameters.

    `state`: "number of the parameter.name of the moment" -> tensor.
    """
    parameters = [one for group in optimiser.param_groups for one in group["params"]]
    moments: dict[int, dict[str, Tensor]] = {}
    for i in sorted({int(name.partition(".")[0]) for name in state}):
        shape = parameters[i].shape
        shapes = {"step": (), "exp_avg": shape, "exp_avg_sq": shape}
        moments[i] = {key: state.get(f"{i}.{key}", torch.empty(0, 0)) for key in shapes}
        if any(moments[i][key].shape != wanted for key, wanted in shapes.items()):
            raise ValueError(f"moments of parameter {i} are not of its shape")
    if len(state) != sum(map(len, moments.values())):
        raise ValueError("moments of other parameters")
    groups = optimiser.state_dict()["param_groups"]
    optimiser.load_state_dict({"state": moments, "param_groups": groups})
