"""MuJoCo scenes: quays, fleet and debris as one model that the force callback understands."""

from mjforage.physics.scene.build import Scene, build_scene, with_bodies
from mjforage.physics.scene.debris import DebrisClass, load_debris, parking_xy

__all__ = ["DebrisClass", "Scene", "build_scene", "load_debris", "parking_xy", "with_bodies"]
