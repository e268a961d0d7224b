"""Items against quays and hulls; forces in contacts are in the validation checks."""

import numpy as np
import pytest

from mjforage.scene import build_scene
from mjforage.simulation import Integrator, Simulation
from mjforage.vessels import load_vessel

FORAGER = load_vessel("forager")
BOTH = pytest.mark.parametrize("integrator", Integrator)
BASIN = np.vstack((np.zeros((1, 9), bool), np.ones((4, 9), bool)))  # a quay along the north
QUAY_Y_M = 14.0


@BOTH
def test_items_stop_at_quays_and_give_way_to_hulls(integrator: Integrator) -> None:
    scene = build_scene([FORAGER], navigable=BASIN, pitch_m=4.0, items=2)
    simulation = Simulation(scene, integrator=integrator)
    simulation.place_vessels(np.array([4.0, 4.0, 0.0]))
    simulation.place_items(np.array([[20.0, 12.0], [8.0, 4.0]]), np.array([0, 2]))
    simulation.item_wind[0, 0] = 0.0, 10.0
    simulation.commands[:] = 60.0
    simulation.step(100)
    (_, y), (x, _) = simulation.item_xy[0]
    assert y == pytest.approx(QUAY_Y_M - 0.1, abs=0.02)
    bow = simulation.vessel_pose[0, 0, 0] + 1.0
    assert x == pytest.approx(bow + 0.1, abs=0.03)
    assert bow > 9.0
