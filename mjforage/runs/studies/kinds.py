"""Kinds of studies: the scenario, policies and options of each by default; light to import."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

STEP = 0.05  # distance of the levels of corruption
_PAPER = ("ddqn", "ddqn-reward", "greedy", "levy", "wanderer")
_INFORMED = ("greedy", "belief", "ddqn")


@dataclass(frozen=True)
class Kind:
    """Defaults of a kind of study.

    Attributes
    ----------
    scenario : name
    policies : references
    options : name -> value
    """

    scenario: str
    policies: tuple[str, ...]
    options: Mapping[str, Any] = field(default_factory=dict)


KINDS: Mapping[str, Kind] = {
    "ablation": Kind("published", _PAPER),
    "corruption": Kind("published", _PAPER, {"step": STEP, "whole_team": False}),
    "paper": Kind("published", _PAPER, {"step": STEP, "whole_team": True}),
    "communication": Kind("comb-port", _INFORMED),
    "sensing": Kind("comb-port", _INFORMED),
}
"""Name -> defaults."""
