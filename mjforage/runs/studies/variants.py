"""The variants that each kind of study plays: pure functions of a scenario."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mjforage.base.errors import UserError
from mjforage.runs.studies.study import Variant
from mjforage.scenario.scenario import CorruptionChoice, Scenario

COMPLETE = "complete"  # the scenario as it is, in every kind of study


def crews(scenario: Scenario) -> str:
    """Number of agents of each team, in words."""
    return ", ".join(f"{name} {role.count}" for name, role in scenario.team.items())


def lesser_name(team: str) -> str:
    """Variant of the fleet with an agent of a team less."""
    return f"{team}-less"


def ablation(scenario: Scenario, policies: Sequence[str]) -> tuple[Variant, ...]:
    """The whole fleet, and every team with one agent less.

    Raises
    ------
    UserError
        If the fleet is one agent.
    """
    if sum(role.count for role in scenario.team.values()) < 2:
        raise UserError(f"scenario {scenario.name}: has one agent, and none can be left out")
    variants = [Variant(COMPLETE, crews(scenario), scenario, tuple(policies))]
    for name, role in scenario.team.items():
        if role.count:
            team = dict(scenario.team) | {name: replace(role, count=role.count - 1)}
            lesser = replace(scenario, team=team)
            variants.append(Variant(lesser_name(name), crews(lesser), lesser, tuple(policies)))
    return tuple(variants)


MOST_LEVELS = 1000


def levels(step: float) -> tuple[float, ...]:
    """Corruption levels from 0 to 1.

    Raises
    ------
    UserError
        If the step leaves fewer than the 5 levels that two lines need, or does not divide 1.
    """
    count = round(1 / step) if step > 0 else 0
    if not 4 <= count <= MOST_LEVELS or abs(count * step - 1) > 1e-9:
        raise UserError(f"step {step:g}: give 1/N with N from 4 to {MOST_LEVELS}, such as 0.05")
    return tuple(float(level) for level in np.round(np.linspace(0, 1, count + 1), 6))


def corrupted_name(team: str, level: float) -> str:
    """Variant of a team at a level of corruption; at level 0 no agent is corrupted."""
    return f"{team}-{level:g}" if level else COMPLETE


def corruption(
    scenario: Scenario, policies: Sequence[str], step: float, whole_team: bool
) -> tuple[Variant, ...]:
    """Every team with its actions replaced by random ones, at every level.

    Raises
    ------
    UserError
        As `levels`.
    """
    calm = replace(scenario, corruption=CorruptionChoice())
    variants = [Variant(COMPLETE, "no corruption", calm, tuple(policies))]
    for team, role in scenario.team.items():
        for level in levels(step)[1:] if role.count else ():
            choice = CorruptionChoice(team, level, whole_team)
            name, title = corrupted_name(team, level), f"{team}, ε = {level:g}"
            corrupted = replace(scenario, corruption=choice)
            variants.append(Variant(name, title, corrupted, tuple(policies)))
    return tuple(variants)


def paper(
    scenario: Scenario, policies: Sequence[str], step: float, whole_team: bool
) -> tuple[Variant, ...]:
    """All of the paper: the whole fleet, the ablations and the corruptions.

    Raises
    ------
    UserError
        As `ablation` and `corruption`.
    """
    calm = replace(scenario, corruption=CorruptionChoice())
    lesser = ablation(calm, policies)
    return (*lesser, *corruption(calm, policies, step, whole_team)[1:])
