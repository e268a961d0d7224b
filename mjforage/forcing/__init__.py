"""Wind and water at any time and place, for all worlds: gusts and lees, streams and circulation.

A value is a function of (seed, episode, time, place) and of nothing else: no time step, no order
of queries, no batch. A scenario's `Weather` says what there is, `Forcing` answers queries.
"""

from mjforage.forcing.forcing import Forcing
from mjforage.forcing.steady import LEEWAY

__all__ = ["LEEWAY", "Forcing"]
