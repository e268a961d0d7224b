"""MuJoCo scenes: quays, fleet and debris as one model that the force callback understands."""

from mjforage.physics.scene.build import Scene, build_scene, check_passages
from mjforage.physics.scene.debris import DebrisClass, load_debris

__all__ = ["DebrisClass", "Scene", "build_scene", "check_passages", "load_debris"]
