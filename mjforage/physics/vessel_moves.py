"""Moves that follow from vessels: the nodes that a hull makes within one decision."""

import math
from bisect import bisect_right
from dataclasses import replace
from functools import partial

from mjforage.base.errors import UserError
from mjforage.mission.setup import Setup
from mjforage.physics.vessel_models import decision_s
from mjforage.physics.vessels import load_vessel
from mjforage.scenario.roles import FROM_VESSEL, MOST_MOVES
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.vessel_files import hull_name


def with_moves(scenario: Scenario) -> Scenario:
    """The scenario with a number in the place of each `moves = "from vessel"`.

    The number is the most nodes that the vessel of the team makes in time diagonally, from rest to
    rest after a turn of 90 degrees, by the vessel model of its controllers (`decision_s`). Raises
    `UserError` if a vessel cannot be read, or does not make one node.
    """
    team = dict(scenario.team)
    for name, role in team.items():
        if role.moves != FROM_VESSEL:
            continue
        hull = hull_name(scenario.physics, name, role.collects)
        vessel, diagonal_m = load_vessel(hull), math.sqrt(2.0) * scenario.map.pitch_m
        times = [decision_s(vessel, n * diagonal_m) for n in range(1, MOST_MOVES + 1)]
        if times[0] > scenario.period_s:
            raise UserError(
                f'scenario {scenario.name}: team.{name}.moves = "{FROM_VESSEL}": vessel '
                f"{vessel.name} takes {times[0]:.3g} s to turn and go {diagonal_m:.3g} m to the "
                f"next node, and a decision has {scenario.period_s:g} s; give a longer period_s "
                "or a shorter map.pitch_m"
            )
        team[name] = replace(role, moves=bisect_right(times, scenario.period_s))
    return replace(scenario, team=team) if team != scenario.team else scenario


def followed(setup: Setup) -> list[str]:
    """Lines on the moves that follow from vessels."""
    teams, physics = setup.scenario.team, setup.scenario.physics
    hulls = {name: hull_name(physics, name, teams[name].collects) for name in setup.following}
    return [
        f"team.{name}.moves = {teams[name].nodes}, from vessel {load_vessel(hull).name}"
        for name, hull in hulls.items()
    ]


open_setup = partial(Setup.of, derive=with_moves)
"""`Setup.of`, with moves that follow from vessels."""
