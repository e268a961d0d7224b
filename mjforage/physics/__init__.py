"""The same mission in MuJoCo: vessels, weather, scene, simulation, dynamics, validation."""

from mjforage.base.environment import mujoco_despite

mujoco_despite()
