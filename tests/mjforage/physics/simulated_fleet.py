"""A fleet in numba's simulator of CUDA, and the same parts called by the host, bit for bit."""

import copy

import numpy as np

from mjforage.bench.on_device import port_fleet
from mjforage.physics.dynamics.ticks import CONTROL_S
from mjforage.physics.floating.drift import drift
from mjforage.physics.port_drive import FLEET, PITCH_M
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation.integrators import Integrator, half_step_s
from mjforage.physics.simulation.simulation import Simulation
from mjforage.physics.vessels import load_vessel
from mjforage.physics.warp_hulls import WarpHulls
from mjforage.scenario.maps import load_map

EPISODES, ITEMS, TICKS = 2, 6, 30

if __name__ == "__main__":
    fleet = port_fleet(EPISODES, ITEMS)
    pilot, afloat, begin = copy.deepcopy((fleet.pilot, fleet.afloat, fleet.pose))
    vessels, water = [load_vessel(name) for name in FLEET], load_map("comb_port").navigable
    scene = build_scene(vessels, navigable=water, pitch_m=PITCH_M, items=0)
    quays = Simulation(scene, 1, integrator=Integrator.FAST, items=ITEMS).item_kinds[1]
    hulls = WarpHulls(scene, EPISODES, step_s=CONTROL_S)
    hulls.place_vessels(begin)
    q, v = (each.numpy() for each in hulls.live[:2])
    pose, velocity = np.zeros((2, *begin.shape))
    shift_s, floated = half_step_s(Integrator.FAST, CONTROL_S), afloat.q.copy()
    for _ in range(TICKS):
        velocity[:] = v.reshape(pose.shape)
        pose[:] = q.reshape(pose.shape) - shift_s * velocity
        hulls.command(pilot.command(fleet.active, pose, velocity))
        hulls.step()
        drift(afloat, quays, CONTROL_S, True, np.arange(EPISODES), 1)
    fleet.run(TICKS)
    fleet.fetch()
    assert np.abs(pose[..., :2] - begin[..., :2]).max() > 0.5  # they have gone somewhere
    assert np.abs(afloat.q - floated).min() > 1e-3  # and the items have drifted
    for found, wanted in zip((fleet.pose, *fleet.afloat), (pose, *afloat), strict=True):
        assert found.tobytes() == wanted.tobytes()
