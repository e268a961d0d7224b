"""Columns of the group's paper of 2025: error and items removed at 33, 66 and 100 % of the steps.

Taken in a run that names them: `--metric mse_33`. The last value of an episode is held. "MSE" is
the paper's name for a root of squared errors (IEEE RA-L 10(5):4930; preprint arXiv 2412.02316).
"""

import numpy as np

from mjforage.mission.scoring.belief_error import ErrorPerColumn
from mjforage.mission.scoring.known import metric
from mjforage.mission.scoring.metric import Batch, FloatArray, Metric
from mjforage.mission.scoring.primary import ItemsRemoved


def after_share(of: type[Metric], name: str, percent: int) -> type[Metric]:
    """Metric NAME_PERCENT: the series of another after a share of the horizon [%], rounded up."""

    class AfterShare(Metric):
        key, label = f"{name}_{percent}", f"{name.upper()}_{percent}"
        unit, better, digits, least, most = of.unit, of.better, of.digits, of.least, of.most
        on_request, compared, drawn = True, False, False

        def value(self, batch: Batch) -> FloatArray:
            """(episode,)."""
            return np.array(batch.series(of)[:, -(-batch.horizon * percent // 100)])

    AfterShare.__doc__ = f"`{of.key}` after {percent} % of the steps, {name.upper()} in 2025."
    return AfterShare


for _percent in (33, 66, 100):
    metric(after_share(ErrorPerColumn, "mse", _percent))
    metric(after_share(ItemsRemoved, "ptc", _percent))
