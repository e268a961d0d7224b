"""Layout of the numerics and userdata that a MuJoCo model and state hold for the callback.

Per model, in ``<custom>``, in this order (all [SI]):

=====================  ====================================================================
``mjforage``           MAGIC, vessels, items, item classes, scheme
``mjforage-vessel-i``  parameters of vessel i, a record of `VESSEL` (`hydrodynamics.parameters`)
``mjforage-items``     (class, 3): mass incl. added mass [kg], air and water drag [N s2/m2]
=====================  ====================================================================

Per simulation, in ``userdata``: (vessel, 10), then (item, 5).
Degrees of freedom: x, y, yaw of each vessel, then x, y of each item.
"""

from typing import Final

from mjforage.physics.hydrodynamics.parameters import VESSEL

MAGIC: Final = 20_260_617.0  # guards the process-global callback against other people's models
HEADER: Final = 5  # numbers in the numeric `mjforage`
N_VESSELS: Final = 1  # places in it
N_ITEMS: Final = 2
N_CLASSES: Final = 3
SCHEME: Final = 4
VESSEL_WIDTH: Final = VESSEL.itemsize // 8  # numbers of a vessel
HEADER_NAME: Final = "mjforage"

INSTANT: Final = 0.0  # scheme: forces at the instant asked for (Runge-Kutta)
AVERAGED: Final = 1.0  # scheme: forces averaged over the coming step (Euler)

ITEM_MASS: Final = 0  # places in an item class
ITEM_AIR: Final = 1
ITEM_WATER: Final = 2
CLASS_WIDTH: Final = 3

WIND: Final = 0  # userdata of a vessel or item: velocity of the air over ground, x, y [m/s]
WATER: Final = 2  # velocity of the water over ground, x, y [m/s]
LOAD: Final = 4  # items aboard a vessel; class of an item, negative if it is not on the water
INPUT_WIDTH: Final = 5  # of an item
LOSS: Final = 5  # share of its thrust that each thruster of a vessel has lost, port, starboard
SPREAD: Final = 7  # by how much its mass, drag and thrust exceed the model's, as shares of it
VESSEL_INPUTS: Final = 10

VESSEL_DOFS: Final = 3
ITEM_DOFS: Final = 2
