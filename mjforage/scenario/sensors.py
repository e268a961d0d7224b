"""The table `[sensors]` of a scenario: errors of scans, and of what vessels measure."""

from dataclasses import dataclass
from typing import Annotated, Literal

from mjforage.base.fields import Within, source

_OAK = source("Luxonis OAK-D W: depth error below 2, 4, 6 % up to 3.5, 6.5, 9 m; 127 deg")
_Chance = Annotated[float, Within(0, 1)]
_Distance = Annotated[float, Within(0, 1e4, "node")]


_GNSS = source(
    "per axis, RMS / 1.41: NovAtel SMART-AG 1.27 m alone, 0.42 m with SBAS, 0.32 m with DGPS; "
    "Leica GS12, RTK: 0.007 m"
)
_MEMORY = source("Garmin 12XL, correlation of errors measured by D. L. Wilson: about 1 min")
_LOG = source("0.02 to 0.03 m/s: HoloOcean, example of a DVL; NovAtel SMART-AG, Doppler")
_GUESS = source("estimate")


@dataclass(frozen=True)
class Sensors:
    """Errors of scans (missed detections, false positives) in every world, and measurement noise of
    vessels; none by default.

    An item in view is detected with a chance p that falls with its distance: all agents that are as
    far detect it or miss it together, in every decision anew.
    """

    position_noise_m: Annotated[float, Within(0, 2, "m")] = 0.0
    """Standard deviation of a position fix per axis."""
    heading_noise_deg: Annotated[float, Within(0, 20, "deg")] = 0.0
    """Standard deviation of the compass."""
    detection: _Chance = 1.0
    """p of an item in view, at distance 0 if it falls with the distance."""
    half_range_node: _Distance = 0.0
    """Distance at which p is half: detection / (1 + exp((d - half_range_node) / slope_node)); 0: it
    does not fall."""
    slope_node: Annotated[float, Within(1e-3, 1e4, "node")] = 1.0
    """Scale of that logistic fall with distance."""
    detection_table: tuple[tuple[_Distance, _Chance], ...] = ()
    """(distance, p), linear between and constant beyond, in the place of the three keys above."""
    persistence: Annotated[float, Within(0, 0.99)] = 0.0
    """Correlation of detecting an item in two steps: some items are hard to see all along. Their p
    are of a beta distribution with that mean, drawn once per item."""
    false_rate: _Chance = 0.0
    """Chance of a false positive per node and epoch; none where a collector is."""
    false_hold: Annotated[int, Within(1, 30000, "decisions")] = 1
    """Length of such an epoch."""
    merge: _Chance = 0.0
    """Chance to miss an item, in a node in which another is detected."""
    fov_deg: Annotated[float, Within(0, 360, "deg")] = 360.0
    """Field of view about the heading; an agent's own node is always seen."""
    map: Literal["last", "filtered"] = "last"
    """Belief about a node: the items of the last scan, or an estimate from all scans."""
    camera_noise_m: Annotated[float, Within(0, 2, "m")] = 0.0
    """Standard deviation per axis of the position of an item's middle in a frame of a collector's
    camera; with 0 there is no camera, and collectors know where items are."""
    camera_range_noise_per_m: Annotated[float, Within(0, 0.1, "1/m"), _OAK] = 0.0065
    """Times the range squared: standard deviation along the line of sight, beyond that."""
    camera_fov_deg: Annotated[float, Within(10, 360, "deg"), _OAK] = 127.0
    """Field of view of the camera about the bow."""
    camera_range_m: Annotated[float, Within(1, 1e4, "m"), _OAK] = 9.0
    """Range of the camera."""
    camera_period_s: Annotated[float, Within(0.1, 10, "s"), source("estimate")] = 0.2
    """Time between two frames, a multiple of 0.1 s."""
    camera_latency_s: Annotated[float, Within(0, 10, "s"), source("estimate")] = 0.2
    """Time until the content of a frame is known, a multiple of 0.1 s."""
    positioning: str = "white"
    """Model of the vessels' own sensors: `white`, position and heading noise and exact velocities;
    `gnss`, these noises and all keys below; or one of your own, `package.module:Class`."""
    position_wander_m: Annotated[float, Within(0, 20, "m"), _GNSS] = 0.0
    """Standard deviation per axis of a Gauss-Markov error of the fixes."""
    position_memory_s: Annotated[float, Within(1, 1e5, "s"), _MEMORY] = 60.0
    """Time constant of that error."""
    outage_s: Annotated[float, Within(0, 1e4, "s")] = 0.0
    """Length of the outages, in which the last fix is repeated; 0: there are none."""
    outage_every_s: Annotated[float, Within(1, 1e5, "s"), _GUESS] = 120.0
    """Time in which there is one outage, at a drawn moment."""
    latency_s: Annotated[float, Within(0, 5, "s"), _GUESS] = 0.0
    """Time from a measurement to the command that uses it, a multiple of 0.1 s."""
    velocity_noise_mps: Annotated[float, Within(0, 1, "m/s"), _LOG] = 0.0
    """Standard deviation per axis of the velocity over ground that a Doppler log measures in the
    vessel's axes."""
    compass_bias_deg: Annotated[float, Within(0, 45, "deg"), _GUESS] = 0.0
    """Standard deviation of a constant error of the compass, drawn per vessel and episode."""
    filter: bool = True
    """True: a filter that knows these errors estimates the position, and speeds beside obstacles
    keep a margin for what it may be off; False: dead reckoning drawn to the fixes."""

    @property
    def perfect(self) -> bool:
        """True if scans show all that is in view, and nothing else."""
        detects = self.detection >= 1.0 and not self.half_range_node and not self.detection_table
        return detects and not (self.false_rate or self.merge) and self.fov_deg >= 360.0


POSITIONING_KEYS = (
    *("position_noise_m", "heading_noise_deg", "positioning", "position_wander_m"),
    *("position_memory_s", "outage_s", "outage_every_s", "latency_s", "velocity_noise_mps"),
    *("compass_bias_deg", "filter"),
)
"""Keys of `Sensors` on the vessels' own sensors."""
