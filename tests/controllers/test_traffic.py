"""Predictions, conflicts, right of way, and the braking that stands behind them."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.controllers.chart import Chart
from mjforage.controllers.conflicts import NONE, Traffic, conflict, runs_aground
from mjforage.controllers.detours import straight_on
from mjforage.controllers.lee_shore import UNLIMITED
from mjforage.controllers.legs import REACTION_S, lay_leg
from mjforage.controllers.prediction import NEVER_S, SAMPLE_S, SAMPLES, predict
from mjforage.controllers.safety import limit_speeds
from mjforage.controllers.state import STATE, VesselState
from mjforage.controllers.steering import start_decision, start_transit
from mjforage.controllers.traffic import plan_fleet, rank_fleet
from mjforage.controllers.vessel_model import MODEL, ModelRecord, packed
from mjforage.physics.vessel_models import vessel_model
from mjforage.physics.vessels import load_vessel
from tests.controllers.plant import FORAGER, SCOUT, sail, vessel_at
from tests.graph_planner.charts import grid

OPEN = np.zeros((0, 0), np.bool_)


def ordered(s: VesselState, p: ModelRecord, x: float, y: float) -> VesselState:
    """The vessel at the start of its decision to go to (x, y), or to stay there."""
    s.origin_x, s.origin_y, s.target_x, s.target_y = s.x, s.y, x, y
    start_decision(s, p, 1.3)
    return s


def traffic(*vessels: VesselState, model: ModelRecord = FORAGER, land: object = OPEN) -> Traffic:
    fleet, n = np.array([*vessels], STATE), len(vessels)
    models = np.array([model] * n, MODEL)
    rank_fleet(fleet, models, np.zeros((SAMPLES, 4)))
    paths = np.zeros((n + 1, SAMPLES, 4))
    return Traffic(fleet, models, paths, np.zeros((n, n)), np.asarray(land, np.bool_), 4.0)


@pytest.mark.parametrize("name", ["scout", "forager"])
def test_predicted_arrivals_are_those_of_the_vessel_within_a_second_or_so(name: str) -> None:
    vessel, yaws, path = load_vessel(name), np.radians([0.0, 70.0, 140.0]), np.zeros((SAMPLES, 4))
    true = sail(vessel, yaws, (4.0, 4.0), 12.0).first_within((4.0, 4.0), 1.0)
    p = packed(vessel_model(vessel))
    for yaw, arrival in zip(yaws, true, strict=True):
        said = predict(vessel_at(0.0, 0.0, yaw), p, math.nan, math.nan, 0.0, 4.0, 4.0, path)
        assert arrival - 1.3 < said < arrival + 0.5


def test_waiting_and_via_points_are_predicted() -> None:
    path = np.zeros((SAMPLES, 4))
    predict(vessel_at(0.0, 0.0), FORAGER, math.nan, math.nan, 3.0, 8.0, 0.0, path)
    assert path[int(3.0 / SAMPLE_S), 0] == 0.0
    assert path[-1, 0] == pytest.approx(8.0, abs=0.5)
    predict(vessel_at(0.0, 0.0), FORAGER, 4.0, 1.5, 0.0, 8.0, 0.0, path)
    assert np.hypot(path[:, 0] - 4.0, path[:, 1] - 1.5).min() < 0.6


def test_conflicts_of_paths() -> None:
    a, b = np.zeros((SAMPLES, 4)), np.zeros((SAMPLES, 4))
    here, s = vessel_at(0.0, 0.0), vessel_at(8.0, 0.0, math.pi)
    predict(here, FORAGER, math.nan, math.nan, 0.0, 8.0, 0.0, a)
    predict(s, FORAGER, math.nan, math.nan, 0.0, 0.0, 0.0, b)
    k = conflict(a, b, FORAGER, FORAGER, 0.0)
    assert 1.0 < k * SAMPLE_S < 3.5  # head-on, they meet halfway
    predict(vessel_at(8.0, 2.5, math.pi), FORAGER, math.nan, math.nan, 0.0, 0.0, 2.5, b)
    assert conflict(a, b, FORAGER, FORAGER, 0.0) == NONE


def test_paths_over_quays() -> None:
    chart, path = Chart(grid("..", ".#"), 4.0), np.zeros((SAMPLES, 4))
    predict(vessel_at(0.0, 4.0), FORAGER, math.nan, math.nan, 0.0, 4.0, 4.0, path)
    assert not runs_aground(path, FORAGER, chart.land, 4.0)
    predict(vessel_at(0.0, 0.0), FORAGER, math.nan, math.nan, 0.0, 4.0, 4.0, path)
    assert runs_aground(path, FORAGER, chart.land, 4.0)


def test_who_arrives_last_goes_first_and_who_stays_comes_last() -> None:
    near = ordered(vessel_at(0.0, 0.0), FORAGER, 4.0, 0.0)
    far = ordered(vessel_at(0.0, 20.0, 1.5), FORAGER, 8.0, 20.0)
    stays = ordered(vessel_at(0.0, 40.0), FORAGER, 0.0, 40.0)
    rank = traffic(near, far, stays).fleet["rank"]
    assert rank[1] < rank[0] < rank[2]


@pytest.mark.parametrize(("model", "far"), [(FORAGER, 8.0), (SCOUT, 4.0), (SCOUT, 8.0)])
def test_a_swap_is_planned_round_each_other(model: ModelRecord, far: float) -> None:
    now = traffic(
        ordered(vessel_at(0.0, 0.0), model, far, 0.0),
        ordered(vessel_at(far, 0.0, math.pi), model, 0.0, 0.0),
        model=model,
    )
    plan_fleet(now)
    assert now.fleet["via"].any()
    assert conflict(now.paths[0], now.paths[1], model, model, 0.0) == NONE


def test_who_cannot_pass_alone_is_met_halfway() -> None:
    """Two scouts a node apart, bow to bow: both go to starboard of the middle."""
    now = traffic(
        ordered(vessel_at(0.0, 0.0), SCOUT, 4.0, 0.0),
        ordered(vessel_at(4.0, 0.0, math.pi), SCOUT, 0.0, 0.0),
        model=SCOUT,
    )
    plan_fleet(now)
    assert now.fleet["via"].all()
    assert now.fleet[0].end_y == -now.fleet[1].end_y < 0.0


def test_plans_are_those_of_the_vessels_alone_whatever_was_planned_before() -> None:
    """Memory for paths is that of all episodes of a batch; 200 crowds, some vessels making room."""
    random, changed = np.random.default_rng(3), 0
    for _ in range(200):
        crowd = []
        for x, y, yaw, dx, dy in random.uniform(-1.0, 1.0, (6, 5)) * (6.0, 6.0, 3.1, 5.0, 5.0):
            stays = random.random() < 0.5
            s = ordered(vessel_at(x, y, yaw), FORAGER, x + dx * (not stays), y + dy * (not stays))
            if stays and random.random() < 0.7:
                s.place_x, s.place_y = x + 0.9, y
                start_transit(s, FORAGER, s.place_x, s.place_y, False)
            crowd.append(s)
        plans = []
        for left in (0.0, 1.0):
            now = traffic(*crowd)
            now.paths[:] = left * random.normal(size=now.paths.shape) * (5.0, 5.0, 1.0, 1.0)
            makes_room = now.fleet["place_x"] != now.fleet["target_x"]
            now.fleet["rank"][makes_room] = NEVER_S + np.flatnonzero(makes_room)
            before = now.fleet.copy()
            plan_fleet(now)
            changed += int((now.fleet != before).any())
            plans.append(now.fleet.tobytes())
        assert plans[0] == plans[1]
    assert changed > 300


def test_who_meets_nobody_goes_straight_on() -> None:
    now = traffic(
        ordered(vessel_at(0.0, 0.0), FORAGER, 4.0, 0.0),
        ordered(vessel_at(0.0, 30.0), FORAGER, 4.0, 30.0),
    )
    plan_fleet(now)
    assert not any(now.fleet[name].any() for name in ("via", "wait", "stuck"))
    assert straight_on(now.fleet[0]).end_x == 4.0


def test_a_vessel_at_rest_makes_room_in_a_corridor() -> None:
    """One cell wide: the mover cannot go round, so the other moves aside."""
    land = Chart(grid("......"), 4.0).land
    now = traffic(
        ordered(vessel_at(0.0, 0.0), SCOUT, 8.0, 0.0),
        ordered(vessel_at(4.0, 0.0), SCOUT, 4.0, 0.0),
        model=SCOUT,
        land=land,
    )
    plan_fleet(now)
    mover, other = now.fleet
    aside = math.hypot(other.place_x - 4.0, other.place_y)
    assert aside > 0.5 or mover.via == 1.0


def limits(*vessels: VesselState) -> NDArray[np.float64]:
    """Fastest safe speeds ahead and astern of the first scout, on open water."""
    fleet = np.array([*vessels], STATE)
    limit_speeds(fleet, np.array([SCOUT] * len(vessels), MODEL), OPEN, 4.0, 0)
    return np.array([fleet[0].most_ahead, fleet[0].most_astern])


def test_nothing_near_no_limit() -> None:
    assert (limits(vessel_at(0.0, 0.0), vessel_at(30.0, 0.0)) == UNLIMITED).all()


def test_a_vessel_ahead_limits_to_what_stops_before_it() -> None:
    ahead, astern = limits(vessel_at(0.0, 0.0), vessel_at(3.0, 0.0))
    room = 3.0 - 1.35 - SCOUT.clearance_m
    reaction = SCOUT.lag_s + REACTION_S
    assert ahead * reaction + ahead**2 / (2.0 * SCOUT.brake_mps2) <= room + 1e-9
    assert ahead > 0.5
    assert astern == UNLIMITED


def test_a_vessel_that_comes_nearer_limits_more() -> None:
    still = limits(vessel_at(0.0, 0.0), vessel_at(3.5, 0.0, math.pi))[0]
    coming = limits(vessel_at(0.0, 0.0), vessel_at(3.5, 0.0, math.pi, speed=1.0))[0]
    assert coming < 0.8 * still


def test_way_is_left_for_a_vessel_with_right_of_way_alone() -> None:
    """It crosses 3 m ahead at 1 m/s and would stop before our bow, but for another second's way."""
    ours, crosses = vessel_at(0.0, 0.0), vessel_at(3.0, -2.5, math.pi / 2, speed=1.0)
    for rank, free in ((1, False), (-1, True)):  # the other's is 0
        ours.rank = rank
        assert (limits(ours, crosses)[0] == UNLIMITED) == free


def test_too_near_it_may_go_away_only() -> None:
    ahead, astern = limits(vessel_at(0.0, 0.0), vessel_at(1.4, 0.0))
    assert ahead < 0.15
    assert astern == UNLIMITED


def test_a_vessel_beside_another_turns_by_the_size_of_that_one() -> None:
    """A forager in the place of a scout is 5 cm nearer: it leaves less room to turn."""
    turns = []
    for other in (SCOUT, FORAGER):
        beside = vessel_at(0.0, 0.1 + 0.5 * (SCOUT.beam_m + FORAGER.beam_m))
        fleet = np.array([vessel_at(0.0, 0.0), beside], STATE)
        limit_speeds(fleet, np.array([SCOUT, other], MODEL), OPEN, 4.0, 0)
        turns.append(fleet[0].most_port)
    assert turns[1] < 0.9 * turns[0]


def test_right_of_way_is_given_anew_in_every_decision() -> None:
    s = vessel_at(0.0, 0.0)
    s.stuck = s.promoted = 1.0
    ordered(s, SCOUT, 4.0, 0.0)
    assert (s.stuck, s.promoted) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("drift", "way"), [((1.0, 0.0), 1.0), ((-1.0, 0.0), -1.0), ((0.0, 1.0), -1.0)]
)
def test_a_vessel_goes_astern_to_what_lies_behind_unless_a_current_runs_against_it(
    drift: tuple[float, float], way: float
) -> None:
    """A scout makes 1.5 m/s astern and 1.94 m/s ahead; the target is 4 m to the west."""
    s = vessel_at(0.0, 0.0)
    s.drift_x, s.drift_y = drift
    lay_leg(s, SCOUT, 0.0, 0.0, -4.0, 0.0, False)
    assert s.way == way
