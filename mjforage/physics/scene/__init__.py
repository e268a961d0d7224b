"""MuJoCo scenes: quays, fleet and debris as one model that the force callback understands."""

from mjforage.physics.scene.build import Scene, build_scene, with_bodies
from mjforage.physics.scene.debris import parking_xy

__all__ = ["Scene", "build_scene", "parking_xy", "with_bodies"]
