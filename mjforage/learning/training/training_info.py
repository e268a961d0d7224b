"""Content of `training.json`, the record of a training folder."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from mjforage.scenario.schema import OPEN


@dataclass(frozen=True)
class TrainingInfo:
    """Content of `training.json`."""

    __pydantic_config__ = OPEN

    command: str
    """The command that made the folder, or words on the call in Python."""
    algorithm: str
    """The class that trained."""
    scenario: Mapping[str, Any]
    """The whole scenario, defaults included."""
    also: tuple[Mapping[str, Any], ...]
    """Scenarios that rounds take in turn with the first."""
    hyperparameters: Mapping[str, Any]
    """All that the algorithm was settings, defaults included."""
    seed: int
    """Seed of the run."""
    device: str
    """Kind of device that it runs on."""
    versions: Mapping[str, str]
    """Versions of what decides the numbers."""
    weights: Mapping[str, str] = field(default_factory=dict)
    """Hash of the weights of the teacher, and of those that the networks began with."""
    evaluate: tuple[Mapping[str, Any], ...] = ()
    """Scenarios of evaluations; absent where it is the first of the run."""
    maps: str = ""
    """Hash of the maps' cells and starts and of records of weather; of a family, of its ends."""
    hulls: str = ""
    """Hash of the hulls, debris and capture models; absent in the graph world."""
    instructions: str = ""
    """Processor's instructions that torch used where the run began, such as AVX2: the last bits of
    what is learned depend on them."""
