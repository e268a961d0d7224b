"""All checks, so that they are registered."""

from mjforage.physics.validation import (
    contacts,
    drifting,
    gusts,
    inertia,
    invariance,
    planar,
    repeats,
    rest,
    steps,
    stopping,
    straight,
    turning,
    zigzag,
)

__all__ = [
    "contacts",
    "drifting",
    "gusts",
    "inertia",
    "invariance",
    "planar",
    "repeats",
    "rest",
    "steps",
    "stopping",
    "straight",
    "turning",
    "zigzag",
]
