"""The belief planner with assumptions that are far from true goes on looking, and never fails."""

from typing import Any

import numpy as np
import pytest

from mjforage.graph_planner.policies import create_policy
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario_file import load_scenario


def played(*overrides: str, episodes: int, policy: str = "belief(fast=true)") -> Mission:
    """Some episodes to their ends."""
    setup = Setup.of(load_scenario("published", overrides))
    mission = Mission(setup)
    mission.reset(0, np.arange(episodes))
    mission.run(create_policy(policy))
    return mission


def collected(*overrides: str, **how: Any) -> float:
    """Share of the items that are collected in 5 episodes."""
    mission = played(*overrides, **{"episodes": 5, **how})
    taken = (mission.state.collected_by >= 0).sum(axis=1)
    return float((taken / mission.initial.n_items).mean())


@pytest.mark.parametrize(
    "wrong",
    [
        ("prior.items_sd=150.0",),
        ("prior.items=10.0",),
        ("prior.spread_node=20.0",),
        ("prior.items=1.0", "prior.items_sd=20000.0"),
    ],
    ids=" ".join,
)
def test_scouts_that_search_in_vain_scan_everywhere(wrong: tuple[str, ...]) -> None:
    assert collected(*wrong) > 0.9


def test_robust_assumptions_of_wide_hotspots_leave_nothing_out() -> None:
    assert collected("prior.spread_node=8.94", policy="belief(fast=true, robust=true)") > 0.9


def test_more_hotspots_than_assumed_are_found() -> None:
    """98 % of their items are discovered; 87 % where no sighting refutes the assumed number."""
    mission = played("items.hotspots=3", episodes=20)
    seen = (mission.ledger.t_discovered >= 0).sum(axis=1) / mission.initial.n_items
    assert seen.mean() > 0.94


def test_a_world_of_few_items_that_is_known_to_be_one() -> None:
    few = ("items.mean=10.0", "items.std=10.0", "prior.items=10.0", "prior.items_sd=10.0")
    assert collected(*few) > 0.9


def test_thousands_of_items_find_room() -> None:
    many = ("items.mean=6000", "items.std=0", "prior.items=6000.0", "items.covariance_node2=300")
    assert collected(*many, "horizon=25", episodes=1) > 0.0
