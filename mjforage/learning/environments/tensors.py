"""Tensors of torch in the place of arrays of NumPy, for batches on a device."""

import importlib
from collections.abc import Mapping
from typing import Any, get_args

import numpy as np

from mjforage.base.device import SIMULATED
from mjforage.base.errors import UserError
from mjforage.base.extras import require
from mjforage.graph_planner.encodings.encoder import TOP
from mjforage.learning.environments.choices import Overrides, override_texts
from mjforage.learning.environments.spaces import MASK
from mjforage.scenario.scenario import Device

TORCH_NAMES = {"cpu": "cpu", "warp-cpu": "cpu", "cuda": "cuda"}


class Tensors:
    """Arrays as tensors on one device, and back."""

    def __init__(self, device: str, world: str) -> None:
        """Check.

        Raises `UserError` if there is no such device, the world has no hulls, or torch is missing.
        """
        if device not in get_args(Device):
            raise UserError(f"device = {device!r}: unknown; choose {', '.join(get_args(Device))}")
        if device != "cpu" and world == "graph":
            raise UserError(f"device {device}: the graph world has no hulls; give world=physics")
        require(f"device {device}", "torch")
        if device == "cuda" and not SIMULATED and not _torch().cuda.is_available():
            raise UserError(
                "device cuda: there is none here for torch; give warp-cpu, or no device"
            )
        self._name = "cpu" if SIMULATED else TORCH_NAMES[device]

    def of(self, value: Any) -> Any:
        """Tensors of all arrays of numbers in something, in memory of their own."""
        import torch

        if isinstance(value, Mapping):
            return {name: self.of(part) for name, part in value.items()}
        if isinstance(value, tuple):
            return tuple(map(self.of, value))
        if isinstance(value, torch.Tensor):
            return value
        return torch.as_tensor(np.array(value)).to(self._name)

    def shown(self, levels: Mapping[str, Any], masks: Any, dtype: str) -> dict[str, Any]:
        """An observation of levels uint8 and masks, wherever they are, in memory of its own."""
        import torch

        seen = {}
        for name, level in levels.items():
            there = torch.as_tensor(level).to(self._name)
            whole = dtype == "uint8"
            seen[name] = there.clone() if whole else there.to(torch.float32) * (1.0 / TOP)
        return {**seen, MASK: torch.as_tensor(masks).to(self._name).clone()}


def _torch() -> Any:
    return importlib.import_module("torch")


def on_host(value: Any) -> Any:
    """The array of a tensor, wherever it is; anything else as it is."""
    return value.detach().cpu().numpy() if hasattr(value, "detach") else value


def with_device(overrides: Overrides, device: str) -> list[str]:
    """Overrides of a scenario, with the engine of its hulls; raises as `override_texts`."""
    return [*override_texts(overrides), f"physics.device={device}"]
