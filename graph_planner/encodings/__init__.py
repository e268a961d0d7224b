"""Encoders of an `Observation` for learners: arrays per agent, quantised to levels of 0 to 255.

One encoder per file, registered by name; each turns the fleet's observation into arrays of
(episode, agent, ...) uint8, where level / 255 is the value in [0, 1]. Policies and environments
share them, so a network sees the same bytes when it is trained and when it is used. A file that is
put here is found without an edit elsewhere; a class in a package of your own is found by the entry
point `mjforage.observations` or by `package.module:Class`.
"""

import importlib
import pkgutil

from mjforage.graph_planner.encodings.encoder import (
    ENCODERS,
    Encoder,
    Shapes,
    create_encoder,
    encoder,
    encoder_class,
    encoder_label,
)
from mjforage.graph_planner.encodings.masks import LegalMoves

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")

__all__ = [
    "ENCODERS",
    "Encoder",
    "LegalMoves",
    "Shapes",
    "create_encoder",
    "encoder",
    "encoder_class",
    "encoder_label",
]
