"""Conformance of metrics, reward terms, observation encoders and positioning models."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.encodings import create_encoder, encoder_class
from mjforage.graph_planner.policies import create_policy
from mjforage.learning.environments.rewards import RewardTerms, term_class
from mjforage.learning.environments.spaces import MASK
from mjforage.mission.episode_log import Tracks
from mjforage.mission.mission import Mission
from mjforage.mission.scoring import METRICS, Metric, Scorer, chosen_metrics
from mjforage.mission.scoring.known import checked
from mjforage.mission.setup import Setup
from mjforage.physics.positioning import POSITIONING, create_positioning
from mjforage.physics.vessel_moves import open_setup
from mjforage.scenario.scenario_file import load_scenario
from mjforage.testing.conformance import ConformanceError, first_difference, run_checks

TICK_S = 0.1  # between two measurements
Array = NDArray[Any]
Play = Callable[[list[int]], list[Array]]
"""Function from numbers of episodes to arrays (episode, ...), one for each step or result."""


@dataclass(frozen=True)
class PartTrial:
    """A metric, term or encoder, by its reference, and the random moves of its checks."""

    name: str
    scenario: str = "comb-port"
    overrides: tuple[str, ...] = ("horizon=8",)
    seed: int = 0

    @cached_property
    def setup(self) -> Setup:
        """Scenario and map."""
        return open_setup(load_scenario(self.scenario, self.overrides))

    def mission(self, episodes: list[int]) -> Mission:
        """A mission at its start."""
        mission = Mission(self.setup)
        mission.reset(self.seed, np.array(episodes))
        return mission

    def error(self, check: str, words: str) -> ConformanceError:
        """Error of a part that fails a check."""
        return ConformanceError(check, f"{self.name} {words}")

    def compare(self, check: str, one: Array, two: Array, before: str, after: str) -> None:
        """Raise the error of a check, words around the difference, if two arrays differ."""
        if found := first_difference(one, two):
            raise self.error(check, f"{before} {found} {after}")


def _check_alone(trial: PartTrial, check: str, play: Play) -> None:
    """An episode gives the same alone, in another order and beside others, and again."""
    whole = play([0, 1, 2])
    for episodes in ([0, 1, 2], [2, 0], [1]):
        for step, (one, two) in enumerate(zip(whole, play(episodes), strict=False)):
            why = "for one episode in two batches; let an episode depend on nothing but itself"
            trial.compare(check, one[episodes], two, "gave", f"at step {step} {why}")


def _played(trial: PartTrial, metric: type[Metric], episodes: list[int]) -> Scorer:
    mission = trial.mission(episodes)
    known = [one for one in chosen_metrics(METRICS.names()) if one.key != metric.key]
    scorer = Scorer(mission, [*known, metric])  # whose series it may ask for
    mission.run(create_policy("greedy"), (scorer,))
    return scorer


def _scores(scorer: Scorer, metric: type[Metric]) -> list[NDArray[Any]]:
    found = scorer.scores()
    series = [found.series[metric.series_name()]] if metric.has_series() else []
    return [found.scalars[metric.key], *series]


def check_metric_is_described(trial: PartTrial) -> None:
    """It has a docstring, whose first paragraph is its definition, and a key of its own."""
    metric = checked(METRICS.find(trial.name), trial.name)
    if not (metric.__doc__ or "").strip() or metric.__doc__ == Metric.__doc__:
        raise trial.error(
            "metric_is_described", "has no docstring; say in its first paragraph what it measures"
        )
    chosen_metrics([trial.name])


def check_metric_alone(trial: PartTrial) -> None:
    """An episode does not depend on its batch; are of the right shape, finite or NaN."""
    metric = checked(METRICS.find(trial.name), trial.name)
    _check_alone(
        trial, "metric_alone", lambda episodes: _scores(_played(trial, metric, episodes), metric)
    )


def check_metric_ends(trial: PartTrial) -> None:
    """It reads no step after an episode's end; its time series keeps its last value.

    Nothing is checked where no episode of 0 to 2 is over before the horizon.
    """
    metric = checked(METRICS.find(trial.name), trial.name)
    scorer = _played(trial, metric, [0, 1, 2])
    plain, log = _scores(scorer, metric), scorer.log
    over = np.arange(log.agent_node.shape[1]) > log.length[:, None]
    for name in (*Tracks._fields, "item_node"):
        array = getattr(log, name).copy()
        if over.any() and array.size:
            array[over] = array.max()
        setattr(log, name, array)
    why = "by what arrays hold after an episode's end; leave out steps after batch.log.length"
    for before, after in zip(plain, _scores(scorer, metric), strict=True):
        trial.compare("metric_ends", before, after, "gave", why)
    why = "after an episode's end; keep its last value"
    for series in plain[1:]:
        last = np.take_along_axis(series, log.length[:, None], axis=1)
        somewhere = ~np.isnan(series).all(axis=0)  # a difference has one step less
        held = np.where(over & somewhere, last, series)
        trial.compare("metric_ends", held, series, "has a time series that is", why)


def _amounts(
    trial: PartTrial, episodes: list[int], terms: RewardTerms | None = None
) -> list[NDArray[Any]]:
    mission, policy = trial.mission(episodes), create_policy("greedy")
    terms = terms or RewardTerms(trial.setup.task, [trial.name])
    mission.prepare(policy)
    found = []
    while mission.active.any():
        played = mission.active.copy()
        terms.before(mission)
        mission.advance(mission.ask(policy))
        found.append(terms.after(mission, played)[trial.name])
    return found


def check_reward_remembers_nothing(trial: PartTrial) -> None:
    """A term that has seen other episodes gives the same as a fresh one."""
    terms = RewardTerms(trial.setup.task, [trial.name])
    _amounts(trial, [2, 3], terms)
    pairs = zip(_amounts(trial, [0, 1]), _amounts(trial, [0, 1], terms), strict=True)
    for step, (one, two) in enumerate(pairs):
        why = f"at step {step} fresh and after other episodes; tell all from step"
        trial.compare("reward_remembers_nothing", one, two, "gave", why)


def check_reward_alone(trial: PartTrial) -> None:
    """An episode gives the same alone, in another order and beside others, and again."""
    _check_alone(trial, "reward_alone", partial(_amounts, trial))


def _pictures(trial: PartTrial, episodes: list[int]) -> list[NDArray[Any]]:
    mission, policy = trial.mission(episodes), create_policy("greedy")
    encoder = create_encoder(trial.name, trial.setup.task)
    encoder.reset(len(episodes))
    mission.prepare(policy)
    found = []
    while mission.active.any():
        levels = encoder.see(mission.observation, np.flatnonzero(mission.active))
        found += [np.array(level, copy=True) for level in levels.values()]
        mission.advance(mission.ask(policy))
    return found


def check_observation_shapes(trial: PartTrial) -> None:
    """`see` gives levels of the shapes of `shapes`: (episode, agent, *shape) uint8."""
    encoder, mission = create_encoder(trial.name, trial.setup.task), trial.mission([0, 1])
    encoder.reset(2)
    levels, agents = encoder.see(mission.observation, np.arange(2)), len(trial.setup.fleet)
    wanted = {name: f"uint8 {(2, agents, *shape)}" for name, shape in encoder.shapes.items()}
    found = {name: f"{level.dtype} {level.shape}" for name, level in levels.items()}
    if found != wanted or MASK in wanted:
        raise trial.error(
            "observation_shapes",
            f"gave {found}; give {wanted}, and nothing of the name {MASK}",
        )


def check_observation_twice(trial: PartTrial) -> None:
    """Looking twice at one step changes nothing."""
    encoder, mission = create_encoder(trial.name, trial.setup.task), trial.mission([0, 1])
    encoder.reset(2)
    policy = create_policy("greedy")
    mission.prepare(policy)
    while mission.active.any():
        rows = np.flatnonzero(mission.active)
        once = {n: v.copy() for n, v in encoder.see(mission.observation, rows).items()}
        for name, level in encoder.see(mission.observation, rows).items():
            why = "for one step; remember by observation.step"
            trial.compare("observation_twice", once[name], level, f"gave {name}", why)
        mission.advance(mission.ask(policy))


def check_observation_alone(trial: PartTrial) -> None:
    """An episode gives the same alone, in another order and beside others, and again."""
    _check_alone(trial, "observation_alone", partial(_pictures, trial))


def _measured(
    trial: PartTrial, episodes: list[int], before: list[int] | None = None
) -> list[NDArray[Any]]:
    """Measurements of vessels on circles, after a start of other episodes if there are any."""
    vessels, found = len(trial.setup.fleet), list[NDArray[Any]]()
    sensors = replace(trial.setup.scenario.sensors, positioning=trial.name)
    model = create_positioning(sensors, (len(episodes), vessels), TICK_S)
    for numbers, ticks in ((before or [], 7), (episodes, 40)):
        if not numbers:
            continue
        keys, found = episode_keys(trial.seed, np.array(numbers)), []
        for tick in range(ticks):
            angle = np.add.outer(0.1 * np.array(numbers), 0.02 * tick + np.arange(vessels))
            c, s, rate = np.cos(angle), np.sin(angle), np.full(angle.shape, 0.2)
            pose, velocity = np.stack((9 * c, 9 * s, angle), -1), np.stack((-s, c, rate), -1)
            seen = model.measure(keys, np.full(len(numbers), tick), pose, velocity)
            found += [np.array(each, copy=True) for each in seen]
        if numbers is before:
            model.reset(np.arange(len(numbers)))
    return found


def check_positioning_shapes(trial: PartTrial) -> None:
    """`measure` gives finite poses, velocities and fixes, of their shapes and kinds."""
    vessels = len(trial.setup.fleet)
    wanted = [f"float64 {(2, vessels, 3)}", f"float64 {(2, vessels, 3)}", f"bool {(2, vessels)}"]
    seen = _measured(trial, [0, 1])
    found = [f"{each.dtype} {each.shape}" for each in seen[:3]]
    if found != wanted or not all(np.isfinite(each).all() for each in seen):
        raise trial.error(
            "positioning_shapes", f"gave {found}; give {wanted}, finite, in a Measured"
        )


def check_positioning_alone(trial: PartTrial) -> None:
    """An episode gives the same alone, in another order and beside others, and again."""
    _check_alone(trial, "positioning_alone", partial(_measured, trial))


def check_positioning_restarts(trial: PartTrial) -> None:
    """Episodes after a reset are those of a fresh model."""
    pairs = zip(_measured(trial, [0, 1]), _measured(trial, [0, 1], [2, 3]), strict=True)
    for number, (one, two) in enumerate(pairs):
        why = f"at tick {number // 3} fresh and after other episodes; forget the rows of reset"
        trial.compare("positioning_restarts", one, two, "gave", why)


METRIC_CHECKS = (check_metric_is_described, check_metric_alone, check_metric_ends)
REWARD_CHECKS = (check_reward_alone, check_reward_remembers_nothing)
OBSERVATION_CHECKS = (
    check_observation_shapes,
    check_observation_twice,
    check_observation_alone,
)
POSITIONING_CHECKS = (
    check_positioning_shapes,
    check_positioning_alone,
    check_positioning_restarts,
)


def check_metric(
    metric: str, scenario: str = "comb-port", overrides: Iterable[str] = ("horizon=150",)
) -> None:
    """All checks of a metric, by its reference.

    Whole episodes are played, of which some are over before others of their batch.

    Raises
    ------
    ConformanceError
        Of the first check that fails.
    UserError
        If there is no such metric or scenario.
    """
    checked(METRICS.find(metric), metric)
    run_checks(METRIC_CHECKS, PartTrial(metric, scenario, tuple(overrides)))


def check_reward(
    reward: str, scenario: str = "comb-port", overrides: Iterable[str] = ("horizon=8",)
) -> None:
    """All checks of a reward term, by its reference; raises as `check_metric`."""
    term_class(reward)
    run_checks(REWARD_CHECKS, PartTrial(reward, scenario, tuple(overrides)))


def check_observation(
    observation: str, scenario: str = "comb-port", overrides: Iterable[str] = ("horizon=8",)
) -> None:
    """All checks of an observation encoder, by its reference; raises as `check_metric`."""
    encoder_class(observation)
    run_checks(OBSERVATION_CHECKS, PartTrial(observation, scenario, tuple(overrides)))


def check_positioning(
    positioning: str, scenario: str = "comb-port-gnss", overrides: Iterable[str] = ()
) -> None:
    """All checks of a positioning model, by its reference; raises as `check_metric`."""
    POSITIONING.bound(positioning)
    run_checks(POSITIONING_CHECKS, PartTrial(positioning, scenario, tuple(overrides)))
