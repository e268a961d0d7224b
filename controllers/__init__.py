"""Guidance, heading and speed loops, thrust allocation and collision avoidance.

Floor 1 of the house: pure functions on arrays, batched over (episode, vessel), knowing nobody.
`Pilot` turns decisions between nodes into thruster commands at 10 Hz; `Helm` is what it knows of a
hull, `Chart` what it knows of the quays. The constants of these files are estimates, chosen in the
proving ground of the tests, unless they name a source.
"""

from mjforage.controllers.chart import Chart
from mjforage.controllers.helm import Helm, Tuning
from mjforage.controllers.pilot import Pilot

__all__ = ["Chart", "Helm", "Pilot", "Tuning"]
