"""Items on the water: those out of every hull's reach move here, the others in MuJoCo.

Both ways have the same equations, so that an item goes over without a jump. `drift` moves it,
`quays` keeps it off land as MuJoCo's contacts do, `bodies` lends it a body near a hull.
"""

from mjforage.physics.floating.bodies import Bodies, lend, take_back
from mjforage.physics.floating.drift import Afloat, drift
from mjforage.physics.floating.quays import Quays, quays_of

__all__ = ["Afloat", "Bodies", "Quays", "drift", "lend", "quays_of", "take_back"]
