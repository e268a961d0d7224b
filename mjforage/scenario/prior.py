"""The prior: assumptions of every planner about a mission before any observation."""

from dataclasses import dataclass
from typing import Annotated

from mjforage.base.fields import Within


@dataclass(frozen=True)
class Prior:
    """Assumptions of planners about items, drift and detection before anything has been seen.

    These are assumptions: they stay as they are when `[items]`, `[weather]` or `[sensors]` say
    something else.
    """

    hotspots: Annotated[int, Within(1, 8)] = 1
    """Clusters that the items come in, unless sightings show up to two more."""
    spread_node: Annotated[float, Within(0.5, 100, "node")] = 4.47
    """Standard deviation of a cluster per axis."""
    items: Annotated[float, Within(1, 20_000, "items")] = 75.0
    """Number of items, mean."""
    items_sd: Annotated[float, Within(1, 20_000, "items")] = 10.0
    """Number of items, standard deviation."""
    drift_node_per_step: Annotated[float, Within(0, 10, "node/step")] = 0.1
    """The largest constant drift expected per axis."""
    noise_node_per_step: Annotated[float, Within(0, 10, "node/step")] = 0.09
    """Independent drift per item, uniform in +- this per axis."""
    detection: Annotated[float, Within(0.01, 1)] = 1.0
    """Chance to detect an item in view, as `sensors.detection`."""
    half_range_node: Annotated[float, Within(0, 1e4, "node")] = 0.0
    """Distance at which that is half, as `sensors.half_range_node`; 0: it does not fall."""
    slope_node: Annotated[float, Within(1e-3, 1e4, "node")] = 1.0
    """Scale of the logistic fall with distance, as `sensors.slope_node`."""
    false_rate: Annotated[float, Within(0, 1)] = 0.0
    """False positives per node and decision."""
