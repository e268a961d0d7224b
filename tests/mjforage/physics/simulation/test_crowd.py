"""Sixteen vessels among 300 items, packed in a corner: what a sparse solver must get right."""

import mujoco
import numpy as np
import pytest

from mjforage.physics.simulation import Integrator
from tests.mjforage.physics.simulation.crowd import (
    ITEMS,
    TOLERANCE_M,
    VESSELS,
    crowd,
    places,
)

SECONDS = {Integrator.FAST: 20, Integrator.REFERENCE: 5}


@pytest.mark.parametrize("integrator", Integrator)
def test_sparse_and_dense_solvers_agree(integrator: Integrator) -> None:
    """Their answers are the same numbers by two ways; of those one was wrong in MuJoCo 4.0.0."""
    sparse, dense = crowd(integrator), crowd(integrator)
    dense.model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    first, second = (places(one, SECONDS[integrator]) for one in (sparse, dense))
    assert first.shape == (SECONDS[integrator], len(VESSELS) + ITEMS, 2)
    assert np.abs(first - second).max() < TOLERANCE_M


def test_vessels_and_items_are_in_contact() -> None:
    simulation = crowd(Integrator.FAST)
    data = mujoco.MjData(simulation.model)
    places(simulation, SECONDS[Integrator.FAST])
    data.qpos[:] = simulation.engine.bind("qpos")[0]
    mujoco.mj_forward(simulation.model, data)
    assert data.ncon > 40
