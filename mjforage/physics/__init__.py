"""The same mission in MuJoCo: vessels, weather, scene, simulation, dynamics."""

from mjforage.base.environment import mujoco_despite

mujoco_despite()
