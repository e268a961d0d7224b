"""Guidance, heading and speed loops, thrust allocation and collision avoidance.

Pure functions on arrays, batched over (episode, vessel). `Pilot` turns decisions between nodes into
thruster commands at 10 Hz; `VesselModel` is what it knows of a vessel, `Chart` what it knows of the
quays. The constants of these files are estimates, chosen in the proving ground of the tests, unless
they name a source.
"""

from mjforage.controllers.chart import Chart
from mjforage.controllers.pilot import Pilot
from mjforage.controllers.vessel_model import Tuning, VesselModel

__all__ = ["Chart", "Pilot", "Tuning", "VesselModel"]
