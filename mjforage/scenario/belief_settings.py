"""What the belief planner assumes and how hard it searches: `[belief]` of a scenario."""

from dataclasses import dataclass, replace
from typing import Annotated

from mjforage.base.fields import Later, Within


@dataclass(frozen=True)
class BeliefSettings:
    """Assumptions, effort and parts of the policy `belief`.

    The assumptions are the planner's, not the world's: they stay as they are when `[items]` or
    `[weather]` of the scenario say something else, and `robust` makes them wide.
    """

    fast: bool = False
    """Whether to search less, for about three times the speed."""
    robust: bool = False
    """Whether to assume up to three hotspots of unknown width and number of items, and twice the
    drift."""
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
    detection: Annotated[Annotated[float, Within(0.01, 1)], Later()] = 1.0
    """Chance to detect an item in view, as `sensors.detection`."""
    half_range_node: Annotated[Annotated[float, Within(0, 1e4, "node")], Later()] = 0.0
    """Distance at which that is half, as `sensors.half_range_node`; 0: it does not fall."""
    slope_node: Annotated[Annotated[float, Within(1e-3, 1e4, "node")], Later()] = 1.0
    """How gradually it falls."""
    false_rate: Annotated[Annotated[float, Within(0, 1)], Later()] = 0.0
    """Items per node and decision that are seen and are none."""
    advection: bool = True
    """Whether known items are carried on by the estimated drift, else they stay where seen."""
    wind: bool = True
    """Whether the drift is estimated from the items' displacements, else taken as zero."""
    hotspot: bool = True
    """Whether expected unseen items guide scouts and foragers, else only what was seen does."""
    particles: bool = True
    """Whether the last unseen items are simulated one by one."""
    preposition: bool = True
    """Whether foragers wait where the hotspot is near, else where they start."""
    joint: bool = True
    """Whether foragers' routes are searched together, else each goes for its nearest item."""
    sweeps: bool = True
    """Whether scouts plan ahead, else each takes the move that shows most at once."""
    look_discount: Annotated[Annotated[float, Within(0.5, 1)], Later(before=1.0)] = 0.9
    """How much a decision counts over the one before it in the time until unseen items are seen;
    below 1 scouts commit themselves to one of several places far apart, as is needed on large
    maps."""
    refresh: bool = True
    """Whether scouts look at known items and outdated beliefs again."""
    link_node: Annotated[Annotated[float, Within(0, 1e6, "node")] | None, Later()] = None
    """How far apart agents are taken to be in contact, 0: nobody is ever heard; absent: as far as
    `[link]` has it where no quay is between."""
    report: Annotated[bool, Later()] = True
    """Whether scouts come back with news to foragers out of reach."""
    alone: Annotated[bool, Later()] = True
    """Whether foragers that hear of nobody look for items by themselves."""
    meet: Annotated[bool, Later()] = False
    """Whether those who have lost touch go to a meeting place in the middle of the map."""
    relay: Annotated[bool, Later()] = True
    """Whether relays stand where most of the others are in their reach, else they look around."""

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

    def in_force(self) -> "BeliefSettings":
        """As `widened`, and without drift where it is taken as zero."""
        settings = self.widened()
        return settings if settings.wind else replace(settings, drift_node_per_step=0.0)
