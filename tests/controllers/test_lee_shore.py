"""Lee shores: vessels keep off where .3 m/s of water sets onto a quay, and get off where it has."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.controllers import Chart
from mjforage.controllers.lee_shore import (
    HEADED,
    LEE_S,
    OFF_M,
    OFF_MPS,
    SLANTED_RAD,
    SLIP_MPS,
    evasive_turn,
    extent,
    heed_lee,
    heed_lee_vessel,
)
from mjforage.controllers.quayside import course_in, note_quays, sets_beside
from mjforage.controllers.safety import limit_speeds, settle
from mjforage.controllers.state import VesselState
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.physics.vessels import load_vessel
from tests.controllers.plant import FORAGER as P
from tests.controllers.plant import FREE, blank, vessel_at
from tests.controllers.walks import PITCH_M, Walk
from tests.graph_planner.charts import grid
from tests.mjforage.mission.by_hand import CALM

FloatArray = NDArray[np.float64]

SET_MPS = 0.3
ROWS = (".......",) * 5
BASIN = Chart(grid(*ROWS), PITCH_M).land  # the southern quay at y = -2
QUAY_Y = -0.5 * PITCH_M
UP, DOWN = 0.5 * math.pi, -0.5 * math.pi


class Shore:
    """Lone vessels at the southern edge of a basin that the current goes out through.

    One per heading; gusts, 0.1 m and 1 degree of noise.
    """

    def __init__(self, name: str, to_deg: float, row: int, headings: int) -> None:
        graph = navigation_graph(grid(*ROWS), PITCH_M, False)
        weather = replace(
            CALM,
            drift_node_per_step=0.04,
            gust_intensity=0.15,
            current_speed_mps=SET_MPS,
            current_to_deg=to_deg,
        )
        noise = (0.1, 0.0175)
        self.walk = Walk(
            graph,
            [load_vessel(name)],
            [(row, 3)],
            scouts=0,
            episodes=headings,
            weather=weather,
            noise=noise,
        )
        self.at = self.walk.centres[self.walk.node]
        pose = np.zeros((headings, 1, 3))
        pose[..., :2] = self.at
        pose[:, 0, 2] = np.linspace(-np.pi, np.pi, headings, endpoint=False) + 0.013
        self.walk.simulation.place_vessels(pose)
        self.fastest = np.zeros(headings)

    def drift(self, seconds: float) -> None:
        """Let the vessels drift, without a decision."""
        for _ in range(round(10.0 * seconds)):
            self.walk.tick()

    def go(self, cells: tuple[int, int], periods: int) -> FloatArray:
        """Order all so many cells east and north; time of arrival [s], infinite if never."""
        target = self.at + PITCH_M * np.array(cells)
        active = np.ones(self.walk.episodes, np.bool_)
        stay = np.full((self.walk.episodes, 1), cells == (0, 0))
        arrival = np.full(self.walk.episodes, np.inf)
        for tick in range(100 * periods):
            if tick % 100 == 0:
                self.walk.pilot.order(active, self.at, target, stay)
            self.fastest = np.fmax(self.fastest, self.walk.tick()[:, 0])
            off = (self.walk.simulation.vessel_pose[..., :2] - target)[:, 0]
            near = np.hypot(off[:, 0], off[:, 1]) < 1.0
            arrival = np.minimum(arrival, np.where(near, 0.1 * (tick + 1), np.inf))
        self.at = target
        return arrival


@pytest.mark.parametrize("name", ["scout", "forager"])
@pytest.mark.parametrize("cells", [(0, 1), (1, 0), (1, 1)], ids=["away", "along", "aslant"])
def test_a_vessel_that_was_carried_onto_the_edge_gets_off(
    name: str, cells: tuple[int, int]
) -> None:
    """Most lie alongside; 10 s are not enough to turn off, 60 s are."""
    shore = Shore(name, 180.0, 4, 16)
    shore.drift(20.0)
    assert shore.walk.touching.all()
    assert np.isfinite(shore.go(cells, 6)).all()
    assert not shore.walk.touching.any()


@pytest.mark.parametrize("name", ["scout", "forager"])
@pytest.mark.parametrize("to_deg", [180.0, 135.0])
def test_vessels_come_to_a_lee_shore_hold_there_and_leave_without_touching(
    name: str, to_deg: float
) -> None:
    shore = Shore(name, to_deg, 2, 16)
    shore.go((0, 0), 1)
    assert (shore.go((0, -2), 3) < 20.0).all()
    shore.go((0, 0), 3)
    assert (shore.go((1, 0), 3) < 30.0).all()
    assert (shore.go((-1, 0), 3) < 30.0).all()
    assert (shore.go((0, 1), 2) < 20.0).all()
    assert (shore.fastest == 0.0).all()


def off_quay(off: float, yaw: float, set_mps: float = SET_MPS) -> VesselState:
    """A vessel so far off the southern quay [m], onto which water sets, amid a cell."""
    s = vessel_at(12.0, QUAY_Y + off, yaw)
    s.drift_y = -set_mps
    return s


@pytest.mark.parametrize("gap", [0.1, 0.6])
def test_bow_on_a_vessel_comes_no_faster_than_its_gap_in_a_while(gap: float) -> None:
    """And goes astern where the gap is less than it keeps."""
    s = off_quay(0.5 * P.length_m + gap, DOWN)
    heed_lee(s, P, BASIN, PITCH_M)
    assert s.most_ahead == pytest.approx((gap - OFF_M) / LEE_S)
    assert s.most_astern == FREE


def test_stern_on_likewise() -> None:
    s = off_quay(0.5 * P.length_m + 0.1, UP)
    heed_lee(s, P, BASIN, PITCH_M)
    assert s.most_astern == pytest.approx((0.1 - OFF_M) / LEE_S)
    assert s.most_ahead == FREE


def test_aslant_it_makes_up_for_what_it_drifts_aside() -> None:
    """A limit u with u cos a + D sin^2 a = the gap in a while."""
    s = off_quay(extent(P, math.cos(0.8)) + OFF_M, DOWN + 0.8)
    heed_lee(s, P, BASIN, PITCH_M)
    assert s.most_ahead == pytest.approx(-SET_MPS * math.sin(0.8) ** 2 / math.cos(0.8))


def test_nearly_broadside_it_is_only_kept_from_closing_faster_than_it_drifts() -> None:
    s = off_quay(0.5 * P.beam_m + 0.1, -0.1)
    heed_lee(s, P, BASIN, PITCH_M)
    assert s.most_ahead == pytest.approx(SLIP_MPS / math.sin(0.1))


@pytest.mark.parametrize("set_mps", [0.05, -SET_MPS])
def test_weak_water_and_a_quay_to_windward_limit_nothing(set_mps: float) -> None:
    s = off_quay(0.5 * P.length_m + 0.1, DOWN, set_mps)
    heed_lee(s, P, BASIN, PITCH_M)
    assert s.most_ahead == s.most_astern == FREE
    assert (s.lee_x, s.lee_y) == (0.0, 0.0)


def test_the_quay_of_the_item_is_free_to_a_bow() -> None:
    s = off_quay(0.5 * P.length_m + 0.1, DOWN)
    s.item_x, s.item_y, s.quay_y = s.x, QUAY_Y + 0.1, -1.0
    heed_lee(s, P, BASIN, PITCH_M)
    assert s.most_ahead == s.most_astern == FREE
    assert evasive_turn(s, P, DOWN + 0.5, 0.5) == (DOWN + 0.5, 0.5)
    assert evasive_turn(s, P, 0.2, 0.5)[1] < 0.0, "but not to come broadside before it"


def test_a_course_along_the_quay_that_water_sets_onto_is_changed() -> None:
    s = off_quay(0.7, 0.0)
    s.x, s.drift_x, s.drift_y = 18.0, 0.05, 0.0
    s.item_x, s.item_y = 25.8, QUAY_Y + 0.2
    for set_mps, course in ((0.0, 0.0), (-0.09, 0.0), (-0.2, DOWN), (0.0, DOWN)):
        s.drift_y = set_mps
        note_quays(s, P, BASIN, PITCH_M)
        assert s.run == pytest.approx(course)
    assert not sets_beside(s)
    s.run, s.drift_x, s.drift_y = 0.0, 0.15, -0.2
    assert not sets_beside(s), "both quays are to leeward, neither clearly more"


@pytest.mark.parametrize(("drift", "course"), [((0.0, 0.0), 0.0), ((0.05, -0.2), DOWN)])
def test_into_a_corner_a_vessel_comes_towards_the_quay_that_water_sets_onto(
    drift: tuple[float, float], course: float
) -> None:
    """The south-eastern corner; without a drift as it heads and the item bears."""
    s = off_quay(0.7, 0.0)
    s.x, (s.drift_x, s.drift_y) = 18.0, drift
    s.item_x, s.item_y, s.quay_x, s.quay_y = 25.8, QUAY_Y + 0.2, 1.0, -1.0
    assert course_in(s, P, BASIN, PITCH_M) == pytest.approx(course)


@pytest.mark.parametrize("drifts", [True, False])
def test_another_vessel_is_kept_off_unless_it_drifts_alike(drifts: bool) -> None:
    s, other = off_quay(8.0, DOWN), off_quay(8.0 - P.length_m - 0.1, DOWN)
    other.vy = -SET_MPS if drifts else 0.0
    heed_lee_vessel(s, P, other, P)
    assert s.most_ahead == (FREE if drifts else pytest.approx((0.1 - OFF_M) / LEE_S))
    fleet, models, sea = np.array([s, other]), np.array([P, P]), np.zeros((0, 0), np.bool_)
    limit_speeds(fleet, models, sea, PITCH_M, 0)
    assert (fleet["most_ahead"][0] < 0.0) == (not drifts)


def test_alongside_a_vessel_turns_its_stern_off() -> None:
    s = off_quay(0.5 * P.beam_m, 0.0)
    s.in_contact = 1.0
    heed_lee(s, P, BASIN, PITCH_M)
    heading, _ = evasive_turn(s, P, UP, 0.0)
    assert heading == pytest.approx(DOWN)
    s.yaw = -0.6  # on its bow, it does not go astern yet
    s.most_ahead = FREE
    heed_lee(s, P, BASIN, PITCH_M)
    assert s.most_ahead == FREE


def test_before_it_turns_through_broadside_it_makes_room() -> None:
    wanted = 0.2
    near, far = off_quay(1.3, DOWN), off_quay(3.0, DOWN)
    for s in (near, far):
        heed_lee(s, P, BASIN, PITCH_M)
    assert evasive_turn(near, P, wanted, 1.0) == pytest.approx((DOWN + SLANTED_RAD, -OFF_MPS))
    assert evasive_turn(far, P, wanted, 1.0)[0] == wanted


def test_broadside_and_soon_there_it_turns_by_the_shorter_way() -> None:
    s = off_quay(1.2, 0.2)
    s.vy = -SET_MPS
    heed_lee(s, P, BASIN, PITCH_M)
    heading, _ = evasive_turn(s, P, 0.0, 0.0)
    assert math.sin(heading) == pytest.approx(1.0)
    s.yaw = -0.2
    heading, _ = evasive_turn(s, P, 0.0, 0.0)
    assert math.sin(heading) == pytest.approx(-1.0)
    assert abs(math.sin(s.yaw)) < HEADED


@pytest.mark.parametrize("rate", [-0.2, 0.2])
def test_broadside_and_soon_there_it_goes_on_as_it_turns_whatever_it_wants(rate: float) -> None:
    for heading in (-0.3, 0.3):
        s = off_quay(1.2, 0.05 * math.copysign(1.0, rate))
        s.vy, s.rate = -SET_MPS, rate
        heed_lee(s, P, BASIN, PITCH_M)
        off, _ = evasive_turn(s, P, heading, 0.0)
        assert math.sin(off) == pytest.approx(math.copysign(1.0, rate))


def test_away_from_lee_shores_nothing_is_changed() -> None:
    s = off_quay(8.0, 0.0)
    heed_lee(s, P, BASIN, PITCH_M)
    assert evasive_turn(s, P, 1.0, 0.7) == (1.0, 0.7)


@pytest.mark.parametrize(
    ("before", "after"),
    [((-0.2, 1.0), (-0.2, 1.0)), ((-0.2, 0.1), (-0.1, 0.1)), ((-0.2, -0.3), (0.0, 0.0))],
)
def test_no_limit_asks_for_what_the_other_forbids(
    before: tuple[float, float], after: tuple[float, float]
) -> None:
    s = blank()
    s.most_ahead, s.most_astern = before
    settle(s)
    assert (s.most_ahead, s.most_astern) == after
