"""Node moves of every kind from every heading, alone on open water: in time, and no farther."""

import numpy as np
import pytest

from mjforage.physics.vessels import load_vessel
from tests.controllers.plant import CONTROL_S, sail

PERIOD_S = 10.0
YAWS = np.radians(np.arange(-180.0, 180.0, 15.0))
ONE, TWO = [(4.0, 0.0), (4.0, 4.0)], [(8.0, 0.0), (8.0, 8.0)]


@pytest.mark.parametrize(
    ("name", "target", "load"),
    [
        *(("scout", target, 0) for target in ONE + TWO),
        *(("forager", target, load) for target in ONE for load in (0, 75)),
        ("ideal", TWO[1], 0),
    ],
)
def test_every_move_arrives_in_its_period(
    name: str, target: tuple[float, float], load: float
) -> None:
    track = sail(load_vessel(name), YAWS, target, PERIOD_S, load=load)
    assert track.first_within(target, 1.0).max() < PERIOD_S - CONTROL_S


@pytest.mark.parametrize(("name", "target"), [("scout", TWO[0]), ("forager", ONE[0])])
def test_vessels_stop_at_their_target_and_keep_to_their_corridor(
    name: str, target: tuple[float, float]
) -> None:
    """A corridor of 4 m leaves 2 m less half the beam on either side."""
    vessel = load_vessel(name)
    track = sail(vessel, YAWS, target, 15.0)
    assert np.abs(track.pose[..., 1]).max() < 2.0 - 0.5 * vessel.beam_m
    assert track.pose[..., 0].max() < target[0] + 0.5
    assert track.off(target)[-1].max() < 0.6


def test_200_seeds_of_headings_targets_and_starts_arrive() -> None:
    """Every waypoint inside the thrust envelope: one node for both, from anywhere near a centre."""
    rng = np.random.default_rng(0)
    for name in ("scout", "forager"):
        for target in ONE:
            yaws, start = rng.uniform(-np.pi, np.pi, 50), tuple(rng.uniform(-0.4, 0.4, 2))
            track = sail(load_vessel(name), yaws, target, PERIOD_S, start=start)
            assert np.isfinite(track.first_within(target, 1.0)).all()
