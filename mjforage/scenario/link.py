"""The table `[link]` of a scenario: communication between agents."""

from dataclasses import dataclass
from typing import Annotated, Literal

from mjforage.base.fields import Within, source

SCAN_BYTES, NODE_BYTES = 6, 3  # of a scan, and more of every occupied node in it
_RF = source("gz-sim, RFComms")


@dataclass(frozen=True)
class Link:
    """Link between agents, which carries scans; by default all agents receive all scans at once.

    With a link every agent acts by what it has seen and received. At the end of every decision
    agents pass on the scans that others in reach lack, the newest first, one hop at a time.
    """

    model: Literal["ideal", "none", "disk", "log-distance", "two-ray"] = "ideal"
    """`ideal`: all agents receive all scans at once; `none`: no agent receives any; `disk`:
    within a range; `log-distance`: power falls with a power of the distance; `two-ray`: with the
    echo of the water."""
    range_m: Annotated[float, Within(0, 1e6, "m")] = 1e6
    """Radius of the disk."""
    wall_db: Annotated[float, Within(0, 1000, "dB")] = 0.0
    """Loss at every land cell on the straight line; a disk ends there if above 0."""
    tx_dbm: Annotated[float, Within(-200, 100, "dBm"), _RF] = 27.0
    """Power of a transmitter."""
    floor_dbm: Annotated[float, Within(-200, 0, "dBm"), _RF] = -90.0
    """Power of the noise, and the least power at which there is a contact."""
    frequency_hz: Annotated[float, Within(1e6, 1e12, "Hz")] = 2.4e9
    """Carrier, of `two-ray`."""
    exponent: Annotated[float, Within(1, 8), _RF] = 2.5
    """Path loss exponent of `log-distance`."""
    l0_db: Annotated[float, Within(0, 200, "dB"), _RF] = 40.0
    """Path loss at 1 m of `log-distance`."""
    shadowing_db: Annotated[float, Within(0, 40, "dB")] = 0.0
    """Standard deviation of the shadowing, drawn per pair and decision."""
    loss: Annotated[float, Within(0, 0.999)] = 0.0
    """Share of the decisions in which a directed link loses all that it carries."""
    burst: Annotated[float, Within(1, 1e6, "decisions")] = 1.0
    """Mean length of such a time (Gilbert and Elliott); 1: decisions are independent, which makes
    it 1 / (1 - loss)."""
    latency: Annotated[int, Within(0, 30000, "decisions")] = 0
    """Time from sending a scan to receiving it."""
    bytes: Annotated[int, Within(0, 1_000_000_000, "B")] = 0
    """Bytes that an agent can send in a decision, 0 without a limit; a scan of n occupied nodes
    takes 6 + 3 n."""
    cells: Annotated[int, Within(0, 1_000_000_000)] = 0
    """The same in cells, of which it takes 1 + n."""
    relay: bool = True
    """True: all agents pass on scans of others; False: only those of teams with `relays`."""
