"""Margins for what positions may be off: what is nearer than it seems is touched slowly."""

import math

import numpy as np
import pytest

from mjforage.controllers import Chart
from mjforage.controllers.contact import TOUCH_QUAY_MPS
from mjforage.controllers.lee_shore import heed_lee
from mjforage.controllers.legs import REACTION_S
from mjforage.controllers.safety import ALONG_MPS, UNSURE_MPS, limit_speeds
from mjforage.controllers.state import STATE, TRANSIT, VesselState
from tests.controllers.plant import FORAGER as P
from tests.controllers.plant import vessel_at
from tests.graph_planner.charts import grid

BASIN = Chart(grid(*(".........",) * 5), 4.0).land  # quays at x = -2 and 34, y = -2 and 18
MODELS = np.array([P] * 2)
REACTION = P.lag_s + REACTION_S


def limited(*vessels: VesselState) -> VesselState:
    """The first of some vessels, with its safe speeds."""
    state = np.zeros(len(vessels), STATE)
    for v, s in enumerate(vessels):
        state[v] = s
        state[v].mode = TRANSIT
    limit_speeds(state, MODELS[: len(vessels)], BASIN, 4.0, 0)
    found: VesselState = state[0]
    return found


def before(gap: float, margin: float, speed: float = 0.0) -> VesselState:
    """A forager bow on before the eastern quay."""
    s = vessel_at(34.0 - 0.5 * P.length_m - gap, 8.0, 0.0, speed)
    s.margin = margin
    return s


@pytest.mark.parametrize("margin", [0.3, 0.8, 1.5])
def test_a_quay_that_is_nearer_by_the_margin_is_touched_slowly(margin: float) -> None:
    """From its limit a vessel brakes to `UNSURE_MPS` at most on what the quay may be away."""
    for gap in np.arange(margin + 0.05, margin + 3.0, 0.2):
        most = min(limited(before(float(gap), margin)).most_ahead, P.cruise_ahead_mps)
        left = most**2 - 2.0 * P.brake_mps2 * max(gap - margin - most * REACTION, 0.0)
        assert left <= UNSURE_MPS**2 + 1e-6
        assert most <= limited(before(float(gap), 0.0)).most_ahead


def test_within_the_margin_a_vessel_goes_on_slowly_and_away_as_it_likes() -> None:
    s = limited(before(0.7, 1.0))
    assert 0.5 * TOUCH_QUAY_MPS < s.most_ahead <= UNSURE_MPS
    assert s.most_astern > 1.0


def test_within_the_margin_of_a_quay_alongside_a_vessel_goes_slowly() -> None:
    """A corner that seems to be passed may be in the way."""
    s = vessel_at(16.0, -2.0 + 0.5 * P.beam_m + 0.5)
    assert limited(s).most_ahead > 1.0
    s.margin = 0.6
    assert limited(s).most_ahead == limited(s).most_astern == ALONG_MPS
    s.margin = 0.4
    assert limited(s).most_ahead > 1.0


def test_the_larger_the_margin_the_slower() -> None:
    """Speeds before a quay and turns beside it fall with the margin and never rise."""
    ahead = [limited(before(1.6, margin)).most_ahead for margin in (0.0, 0.3, 0.6, 0.9, 1.2)]
    assert (np.diff(ahead) <= 0.0).all() and ahead[-1] < 0.6 * ahead[0]
    turns = []
    for margin in (0.0, 0.1, 0.2, 0.3):
        s = vessel_at(16.0, -2.0 + 0.5 * P.beam_m + 0.5)
        s.margin = margin
        turns.append(limited(s).most_port)
    assert (np.diff(turns) < 0.0).all()


def test_two_vessels_keep_what_both_may_be_off() -> None:
    """The gap counts as less by the root of the sum of squares: positions are off independently."""
    alone = limited(before(20.0, 0.0), vessel_at(12.0 + 4.5, 8.0, math.pi))
    seen = []
    for own, others in ((0.3, 0.4), (0.5, 0.0), (0.0, 0.5)):
        s, other = before(20.0, own), vessel_at(12.0 + 4.5, 8.0, math.pi)
        other.margin = others
        seen.append(limited(s, other).most_ahead)
    assert seen[0] == pytest.approx(seen[1]) == pytest.approx(seen[2])
    nearer = limited(before(20.0, 0.0), vessel_at(12.0 + 4.0, 8.0, math.pi))
    assert seen[0] == pytest.approx(nearer.most_ahead) and seen[0] < alone.most_ahead


def test_a_lee_shore_counts_as_nearer_by_the_margin() -> None:
    def most(gap: float, margin: float) -> float:
        s = before(gap, margin)
        s.drift_x = 0.3
        heed_lee(s, P, BASIN, 4.0)
        return s.most_ahead

    assert most(1.4, 0.5) == pytest.approx(most(0.9, 0.0))
    assert most(1.4, 0.5) < most(1.4, 0.0)
