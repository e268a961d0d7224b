"""The board: every policy on the same episodes of several courses, and those left out of each."""

from collections.abc import Sequence

import numpy as np

from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.policies import create_policy
from mjforage.graph_planner.policies.registry import check_policies, policy_names
from mjforage.runs.evaluate import check_numbers
from mjforage.runs.studies.benchmark_tasks import BenchmarkTask
from mjforage.runs.studies.study import LeftOut, Study, Variant

FLOOR, CEILING = "random", "oracle"
"""Policies between which scores are normalised: 0 is the one's mean, 1 the other's."""


def board(
    courses: Sequence[BenchmarkTask],
    policies: Sequence[str] = (),
    *,
    episodes: int = 100,
    seed: int = 0,
    metrics: Sequence[str] = (),
) -> Study:
    """The study in which policies play courses, each course a variant.

    Raises `UserError` if a policy that was asked for cannot play a course, or none can.

    Parameters
    ----------
    courses : in their order
    policies : references; none: all that have a name. Of those, one that cannot play a course is
        left out of it, and the study says why
    episodes, seed, metrics : as of `Study`
    """
    check_numbers(episodes, seed)
    variants, left_out = [], []
    wanted = check_policies(policies) if policies else policy_names()
    for one in courses:
        reasons = {name: _why_not(name, one) for name in wanted}
        missing = {name: why for name, why in reasons.items() if why}
        players = tuple(name for name in reasons if name not in missing)
        if missing and (policies or not players):
            raise UserError(f"course {one.name}: {next(iter(missing.values()))}")
        left_out += [LeftOut(name, one.name, why) for name, why in missing.items()]
        about = one.setup.scenario, players, one.setup.grid, (one.world,)
        variants.append(Variant(one.name, one.name, *about))
    worlds = tuple(dict.fromkeys(one.world for one in courses))
    return Study(
        "board",
        courses[0].setup,
        tuple(variants),
        worlds,
        episodes,
        seed,
        metrics=tuple(metrics),
        left_out=tuple(left_out),
    )


def _why_not(policy: str, course: BenchmarkTask) -> str:
    """Reason why a policy cannot begin an episode of a course; "" if it can."""
    task = course.setup.task
    try:
        create_policy(policy).reset(task, episode_keys(0, np.zeros(1, np.int64)))
    except UserError as error:
        return str(error)
    return ""
