"""Positioning: sensor models that measure position, heading and velocity of vessels.

One class in one file each. A file that is put beside these is found without an edit elsewhere; a
class in a package of your own is found by the entry point `mjforage.positioning` or by
`package.module:Class`.
"""

import importlib
import pkgutil

from mjforage.physics.positioning.model import (
    POSITIONING,
    Measured,
    Positioning,
    create_positioning,
    positioning_class,
)

__all__ = ["POSITIONING", "Measured", "Positioning", "create_positioning", "positioning_class"]

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")
