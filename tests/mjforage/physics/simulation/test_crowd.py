"""The crowd that is compared with another MuJoCo is one: `make mujoco` runs `crowd.py`."""

import mujoco

from mjforage.physics.simulation import Integrator
from tests.mjforage.physics.simulation.crowd import crowd, places

SECONDS = 20


def test_vessels_and_items_are_in_contact() -> None:
    simulation = crowd(Integrator.FAST)
    data = mujoco.MjData(simulation.model)
    places(simulation, SECONDS)
    data.qpos[:] = simulation.engine.bind("qpos")[0]
    mujoco.mj_forward(simulation.model, data)
    assert data.ncon > 40
