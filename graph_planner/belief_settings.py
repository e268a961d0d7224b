"""What the belief planner assumes and how hard it searches: `[belief]` of a scenario."""

from dataclasses import dataclass, field, replace
from typing import Any


def _between(low: float, high: float, default: Any) -> Any:
    """A field with a default and the closed range that scenario files are held to."""
    return field(default=default, metadata={"low": low, "high": high})


@dataclass(frozen=True)
class BeliefSettings:
    """Assumptions, effort and parts of the belief planner.

    The assumptions are the planner's, not the world's: they stay as they are when `[items]` or
    `[weather]` of the scenario say something else, and `robust` makes them wide.

    Attributes
    ----------
    fast : search less, for about three times the speed
    robust : assume up to three hotspots of unknown width and number of items, and twice the drift
    hotspots : clusters that the items come in, unless sightings show up to two more
    spread_node : standard deviation of a cluster per axis [node]
    items, items_sd : number of items, mean and deviation
    drift_node_per_step : the largest constant drift expected per axis [node/step]
    noise_node_per_step : independent drift per item, uniform in +- this per axis [node/step]
    advection : known items are carried on by the estimated drift, else they stay where seen
    wind : the drift is estimated from the items' displacements, else taken as zero
    hotspot : expected unseen items guide scouts and foragers, else only what was seen does
    particles : the last unseen items are simulated one by one
    preposition : foragers wait where the hotspot is near, else where they start
    joint : foragers' routes are searched together, else each goes for its nearest item
    sweeps : scouts plan ahead, else each takes the move that shows most at once
    refresh : scouts look at known items and outdated beliefs again
    """

    fast: bool = False
    robust: bool = False
    hotspots: int = _between(1, 8, 1)
    spread_node: float = _between(0.5, 100, 4.47)
    items: float = _between(1, 20_000, 75.0)
    items_sd: float = _between(1, 20_000, 10.0)
    drift_node_per_step: float = _between(0, 10, 0.1)
    noise_node_per_step: float = _between(0, 10, 0.09)
    advection: bool = True
    wind: bool = True
    hotspot: bool = True
    particles: bool = True
    preposition: bool = True
    joint: bool = True
    sweeps: bool = True
    refresh: bool = True

    def widened(self) -> "BeliefSettings":
        """The assumptions in force: with `robust`, wide ones around those given."""
        if not self.robust:
            return self
        return replace(
            self,
            hotspots=max(3, self.hotspots),
            spread_node=1.4 * self.spread_node,
            items_sd=max(0.5 * self.items, self.items_sd),
            drift_node_per_step=2.0 * self.drift_node_per_step,
        )
