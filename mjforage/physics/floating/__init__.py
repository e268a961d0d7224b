"""Floating items: those out of every vessel's reach move here, the others in MuJoCo.

Both ways have the same equations, so that an item goes over without a jump. `drift` moves it,
`quays` keeps it off land as MuJoCo's contacts do, `body_pool` gives an item a body near a vessel,
`item_contacts` keeps items apart.
"""

from mjforage.physics.floating.body_pool import Bodies, activate, sync_items
from mjforage.physics.floating.drift import Afloat, drift
from mjforage.physics.floating.item_contacts import separate
from mjforage.physics.floating.quays import Quays, quays_of

__all__ = ["Afloat", "Bodies", "Quays", "activate", "drift", "quays_of", "separate", "sync_items"]
