"""Training runs of a few rounds, for tests."""

from dataclasses import replace

from mjforage.learning.training.hyperparameters import Hyperparameters, changed
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario

TINY = {
    "num_envs": 3,
    "capacity": 1000,
    "batch": 16,
    "warmup": 40,
    "explore_updates": 20,
    "evaluate_every": 15,
    "evaluate_episodes": 2,
}


def scenario() -> Scenario:
    return load_scenario("published", ("horizon=12",))


def comb_port(*changes: str) -> Scenario:
    return load_scenario("comb-port", ("horizon=12", *changes))


def on(reference: str) -> Scenario:
    """The same on another map."""
    return placed(comb_port(), reference)


def hyperparameters(**changes: object) -> Hyperparameters:
    return changed(Hyperparameters(), TINY | changes)


def small(**changes: object) -> Hyperparameters:
    """Of a run that is judged at its end only."""
    return hyperparameters(warmup=20, evaluate_every=1000, evaluate_episodes=5, **changes)


def placed(home: Scenario, reference: str) -> Scenario:
    """A scenario on another map, or a family of harbours, without starts of its own."""
    return replace(home, map=replace(home.map, file=reference, starts=None))
