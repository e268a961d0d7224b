"""The variants that each kind of study plays: pure functions of a scenario."""

from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np

from mjforage.base.errors import UserError
from mjforage.runs.study import Variant
from mjforage.scenario.belief_settings import BeliefSettings
from mjforage.scenario.scenario import CorruptionChoice, Scenario

COMPLETE = "complete"  # the scenario as it is, in every kind of study
BASELINES = ("greedy", "oracle")  # what the belief planner is held against
PARTS = tuple(part.name for part in fields(BeliefSettings) if part.default is True)
IN_TOUCH = ("report", "alone", "relay")
"""Those of them that do something over a link only."""
WRONG = ("hotspots", "two-hotspots", "spread", "drift", "calm")
"""Worlds that the belief planner does not expect, by name."""


def parts(scenario: Scenario) -> tuple[Variant, ...]:
    """The belief planner whole, with each part switched off, and in worlds it does not expect."""
    whole = [Variant(COMPLETE, "whole planner", scenario, ("belief", *BASELINES))]
    for part in PARTS:
        if part in IN_TOUCH and scenario.link.model == "ideal":
            continue
        settings = replace(scenario.belief, **{part: False})
        lesser = replace(scenario, belief=settings)
        whole.append(Variant(f"no-{part}", f"without {part}", lesser, ("belief",)))
    fast = replace(scenario, belief=replace(scenario.belief, fast=True))
    whole.append(Variant("fast", "fast", fast, ("belief",)))
    whole += _wary(COMPLETE, "expected world", scenario)[1:]
    items = scenario.items
    variance = items.covariance_node2
    worlds = (
        ("3 hotspots", replace(scenario, items=replace(items, hotspots=3))),
        ("2 hotspots", replace(scenario, items=replace(items, hotspots=2))),
        (
            f"spread {2 * variance**0.5:.3g}",
            replace(scenario, items=replace(items, covariance_node2=4 * variance)),
        ),
        _drifting(scenario, 2.0),
        _drifting(scenario, 0.5),
    )
    for name, (title, world) in zip(WRONG, worlds, strict=True):
        whole += _wary(name, title, world)
    return tuple(whole)


def _drifting(scenario: Scenario, factor: float) -> tuple[str, Scenario]:
    """The scenario with so many times the constant drift, or the wind that makes it; its title."""
    wind, drift = scenario.weather.wind_speed_mps, scenario.weather.drift_node_per_step
    if wind is not None:
        wind = factor * wind
        weather = replace(scenario.weather, wind_speed_mps=wind)
        return f"wind of {wind:g} m/s", replace(scenario, weather=weather)
    weather = replace(scenario.weather, drift_node_per_step=factor * drift)
    return f"drift up to {factor * drift:g}", replace(scenario, weather=weather)


def _wary(name: str, title: str, scenario: Scenario) -> list[Variant]:
    """A world with the planner as it is, and set to wide assumptions."""
    robust = replace(scenario, belief=replace(scenario.belief, robust=True))
    return [
        Variant(name, title, scenario, ("belief", *BASELINES)),
        Variant(f"{name}-robust", f"{title}, robust", robust, ("belief",)),
    ]


def crews(scenario: Scenario) -> str:
    """How many of each team, in words."""
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
        raise UserError(f"--step {step:g}: give 1/N with N from 4 to {MOST_LEVELS}, such as 0.05")
    return tuple(float(level) for level in np.round(np.linspace(0, 1, count + 1), 6))


def corrupted_name(team: str, level: float) -> str:
    """Variant of a team at a level of corruption; nobody is corrupted at 0."""
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
