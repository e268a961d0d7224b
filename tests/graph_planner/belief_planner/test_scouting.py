"""Scouts in turn, against one search after the other."""

import numpy as np
from numpy.typing import NDArray

from mjforage.graph_planner.belief_planner.covers import hotspot_cover
from mjforage.graph_planner.belief_planner.scouting import Scouting
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.sweeps import (
    LONGEST,
    Cover,
    lateness,
    search_sweep,
    sight,
    until_seen,
)
from mjforage.graph_planner.belief_planner.ways import ways_of
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.moves import MoveRules
from mjforage.scenario.roles import Role
from tests.graph_planner.driver import task_of

F64 = NDArray[np.float64]

SEA = navigation_graph(np.ones((30, 30), np.bool_), 1.0, False)
TASK = task_of(
    SEA,
    drone=Role(2, 2, 4.0, False),
    boat=Role(1, 1, 2.0, False),
    glider=Role(1, 2, 4.0, False),
    tug=Role(1, 1, 1.0, True),
)
SETTINGS = BeliefSettings(fast=True, look_discount=0.9)
LATE = lateness(0.9)
BEAM, DEPTH = 6, 6  # of `fast`


def in_turn(scouting: Scouting, covers: list[Cover], at: Int32Array, mass: F64) -> F64:
    """Preferences (agent, 9) of scouts that plan whole paths, each of what those before leave."""
    nodes = at[scouting.agents].astype(np.int32)
    ends_at, preferences = nodes.copy(), np.zeros((len(TASK.fleet), 9))
    path = np.zeros(DEPTH, np.int32)
    for i, agent in enumerate(scouting.agents):
        elsewhere = np.full(covers[i].decisions.shape[1], LONGEST)
        for j in range(len(nodes)):
            if j != i:
                until_seen(covers[j], ends_at[j], float(DEPTH * (j < i)), elsewhere)
        ends = ways_of(SEA, int(TASK.fleet.moves[agent]), MoveRules(True, True)).ends
        scratch, row = sight(len(SEA)), preferences[agent]
        about = elsewhere, LATE, BEAM, DEPTH, True, scratch, row, path
        n = search_sweep(ends, covers[i], nodes[i], mass, *about)
        for node in path[:n]:
            mass[covers[i].cells[covers[i].start[node] : covers[i].start[node + 1]]] = 0.0
        ends_at[i] = path[n - 1] if n else ends_at[i]
    return preferences


def test_scouts_plan_one_after_the_other_each_with_its_own_eyes() -> None:
    """By plain sight and by what would be noticed of hotspots, in turn with the same searches."""
    agents = TASK.fleet.discoverers
    scouting = Scouting(TASK, SETTINGS, agents)
    noticed = [hotspot_cover(TASK, int(a), SETTINGS).cover for a in agents]
    for seed in range(8):
        rng = np.random.default_rng(seed)
        for covers in (scouting.covers, noticed):
            mass = rng.uniform(0, 1, covers[0].landmark.size)
            mass[rng.random(mass.size) < 0.7] = 0.0
            at = rng.integers(0, len(SEA), len(TASK.fleet)).astype(np.int32)
            expected = in_turn(scouting, covers, at, mass.copy())
            found = np.zeros_like(expected)
            scouting.look(at, mass.copy(), found, None if covers is scouting.covers else covers)
            np.testing.assert_array_equal(found, expected)
