"""The belief planner's settings: the options of the policy `belief`, and the prior in force."""

from dataclasses import dataclass, fields
from typing import Annotated, Self

from mjforage.base.fields import Within
from mjforage.scenario.prior import Prior

LAW_OF_ITEMS = "their law"
"""Facts of items that planners are told, as in `[prior]`: number, clusters, spread, drift."""


@dataclass(frozen=True, eq=False)
class BeliefOptions:
    """Effort and parts of the belief planner."""

    fast: bool = False
    """Search less, for about one and a half times the speed."""
    robust: bool = False
    """Assume up to three hotspots of unknown width and number of items, and twice the
    drift of the prior."""
    advection: bool = True
    """Known items are carried on by the estimated drift, else they stay where seen."""
    wind: bool = True
    """The drift is estimated from the items' displacements, else taken as zero."""
    hotspot: bool = True
    """Expected unseen items guide scouts and foragers, else only what was seen does."""
    preposition: bool = True
    """Foragers wait where the hotspot is near, else where they start."""
    joint: bool = True
    """Foragers' routes are searched together, else each goes for its nearest item."""
    sweeps: bool = True
    """Scouts plan ahead, else each takes the move that shows most at once."""
    look_discount: Annotated[float, Within(0.5, 1)] = 0.9
    """Weight of a decision over the one before it in the time until unseen items are seen;
    below 1 scouts commit themselves to one of several places far apart, as is needed on large
    maps."""
    refresh: bool = True
    """Scouts look at known items and outdated beliefs again."""
    report: bool = True
    """Scouts come back with news to foragers out of reach."""
    alone: bool = True
    """Foragers out of contact search for items by themselves."""
    relay: bool = True
    """Relays stand where most of the others are in their reach, else they look around."""


@dataclass(frozen=True)
class BeliefSettings(BeliefOptions, Prior):
    """Assumptions, effort and parts of the planner."""

    @classmethod
    def of(cls, prior: Prior, options: BeliefOptions | None = None) -> Self:
        """The options, by default all at theirs, and the prior that they make wide or calm."""
        options = options or BeliefOptions()
        given = {one.name: getattr(options, one.name) for one in fields(BeliefOptions)}
        assumed = dict(vars(prior))
        if options.robust:
            assumed |= {
                "hotspots": max(3, prior.hotspots),
                "spread_node": 1.4 * prior.spread_node,
                "items_sd": max(0.5 * prior.items, prior.items_sd),
                "drift_node_per_step": 2.0 * prior.drift_node_per_step,
            }
        if not options.wind:
            assumed["drift_node_per_step"] = 0.0
        return cls(**assumed, **given)
