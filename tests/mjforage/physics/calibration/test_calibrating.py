"""The shipped capture model of the forager against trials that are made afresh."""

import numpy as np
import pytest

from mjforage.mission.capture_rule import capture_cell
from mjforage.physics.calibration import collected_in
from mjforage.physics.calibration.trials import draw, seen_from_vessel
from mjforage.physics.vessels import load_vessel
from mjforage.scenario.capture import FROM_DEG, FROM_M, QUAYS, Quays, load_capture

FORAGER = load_vessel("forager")


@pytest.mark.parametrize("quays", QUAYS)
def test_vessels_begin_afloat_and_away_from_items_that_lie_where_they_are_said_to(
    quays: Quays,
) -> None:
    trials = draw(np.random.default_rng(0), FORAGER, quays, 2000, 2)
    assert 500 < len(trials.pose) <= 2000
    inside = np.abs(trials.items - trials.node[:, None])
    assert inside.max() <= 2.0
    edge = np.minimum(trials.items + 2.0, 18.0 - trials.items) < 0.6
    assert (edge.sum(axis=-1) == QUAYS.index(quays)).all()
    ahead, aside = seen_from_vessel(trials)
    assert np.maximum(np.abs(ahead) - 1.0, np.abs(aside) - 0.54).min() > 0.0
    assert trials.pose[:, :2].min() > -2.0 + 0.54 and trials.pose[:, :2].max() < 18.0 - 0.54


@pytest.mark.parametrize("quays", QUAYS)
def test_fresh_trials_agree_with_the_shipped_model(quays: Quays) -> None:
    """Sums over all cells, within four standard deviations of both counts."""
    model = {(c.from_m, c.from_deg): c for c in load_capture("forager").cells if c.quays == quays}
    trials = draw(np.random.default_rng(99), FORAGER, quays, 250)
    found = collected_in("forager", trials, 2, 99)[:, 0]
    expected = np.zeros((2, len(found)))
    spread = np.zeros_like(expected)
    apart = trials.items[:, 0] - trials.pose[:, :2]
    for n, (east, north) in enumerate(apart):
        i, j = capture_cell(east, north, trials.pose[n, 2])
        cell = model[FROM_M[i], FROM_DEG[j]]
        shares = np.cumsum(cell.taken)[:2] / cell.trials
        expected[:, n] = shares
        spread[:, n] = shares * (1.0 - shares) * (1.0 + len(found) / cell.trials)
    for decision in range(2):
        deviation = np.sqrt(spread[decision].sum())
        assert np.sum(found <= decision) == pytest.approx(
            expected[decision].sum(), abs=4.0 * deviation + 1.0
        )
