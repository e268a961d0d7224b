"""The part of a large run that a page shows, and the note about it."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mjforage.base.errors import UserError
from mjforage.view.report.run_logs import Case, RunLogs
from mjforage.view.report.step_means import POINTS

POLICIES = 20  # that figures and pairs show
PAIRS = 200  # of policies, over all worlds
RANKED_BY = "pta_c"


def shown_policies(logs: RunLogs, wanted: Sequence[str] = ()) -> tuple[str, ...]:
    """Policies that figures, pairs and the replay show, in their fixed order.

    All of a usual run; of more than `POLICIES`, or than fit into `PAIRS`, the best by the items
    removed in the end, mean over the worlds. Raises `UserError` if a wanted one is not of the run.

    `wanted`: policies that a user wants to see; none for all.
    """
    for policy in wanted:
        if policy not in logs.run.policies:
            names = ", ".join(logs.policies[:POLICIES])
            more = " and others" if len(logs.policies) > POLICIES else ""
            raise UserError(f"policy {policy}: is not in this run; choose {names}{more}")
    several = tuple(one for one in logs.policies if one in wanted) or logs.policies
    most = POLICIES
    while most > 2 and math.comb(most, 2) * len(logs.run.worlds) > PAIRS:
        most -= 1
    best = sorted(several, key=lambda policy: -_rank(logs, policy))[:most]
    return tuple(one for one in several if one in best)


def _rank(logs: RunLogs, policy: str) -> float:
    """Mean over the worlds of the metric of the ranking; undefined is worst."""
    means = [Case(logs, world, policy).summary(RANKED_BY).mean for world in logs.run.worlds]
    return -math.inf if math.isnan(mean := float(np.mean(means))) else mean


def only(logs: RunLogs, policies: tuple[str, ...]) -> RunLogs:
    """The run as if it had these policies alone."""
    if set(policies) == set(logs.run.policies):
        return logs
    few = tuple(one for one in logs.run.policies if one in policies)
    return replace(logs, run=replace(logs.run, policies=few))


def left_out(logs: RunLogs, shown: RunLogs) -> str:
    """Sentences on the parts that are not on the page, and the command that shows them."""
    notes = []
    if len(shown.policies) < len(logs.policies):
        notes.append(
            f"Figures, pairs, replay and the longer tables show {len(shown.policies)} of the "
            f"{len(logs.policies)} policies: the best by PTA_C, or those that were "
            "asked for. Result in brief and the files in `tables/` have all; `mjforage report "
            "FOLDER --policy NAME --policy NAME` shows others."
        )
    if logs.run.horizon > POINTS:
        notes.append(
            f"Curves are drawn at {POINTS + 1} of the {logs.run.horizon + 1} steps, evenly apart; "
            "`steps.parquet` has all."
        )
    return " ".join(notes)
