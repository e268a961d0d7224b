"""Columns of the group's paper of 2025: error and items removed at 33, 66 and 100 % of the steps.

Taken in a run that names them: `--metric mse_33`. The last value of an episode is held. "MSE" is
the paper's name for a root of squared errors (IEEE RA-L 10(5):4930; preprint arXiv 2412.02316).
"""

from typing import ClassVar

import numpy as np

from mjforage.mission.scoring.belief_error import ErrorPerColumn
from mjforage.mission.scoring.known import metric
from mjforage.mission.scoring.metric import Batch, FloatArray, Metric
from mjforage.mission.scoring.primary import ItemsRemoved


class AfterShare(Metric):
    """Base of a series' values after a share of the steps, rounded up.

    Attributes
    ----------
    of : whose series
    percent : of the horizon [%]
    """

    of: ClassVar[type[Metric]]
    percent: ClassVar[int]
    on_request, compared, drawn, least = True, False, False, 0.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,)."""
        return np.array(batch.series(self.of)[:, -(-batch.horizon * self.percent // 100)])


class _Mse(AfterShare):
    of, better, digits = ErrorPerColumn, -1, ErrorPerColumn.digits
    unit, most = ErrorPerColumn.unit, ErrorPerColumn.most


class _Ptc(AfterShare):
    of, better, digits = ItemsRemoved, 1, ItemsRemoved.digits
    unit, most = ItemsRemoved.unit, ItemsRemoved.most


@metric
class Mse33(_Mse):
    """`rmse_columns` after a third of the steps, "MSE" of the paper of 2025."""

    key, label, percent = "mse_33", "MSE_33", 33


@metric
class Mse66(_Mse):
    """`rmse_columns` after two thirds of the steps, "MSE" of the paper of 2025."""

    key, label, percent = "mse_66", "MSE_66", 66


@metric
class Mse100(_Mse):
    """`rmse_columns` after all steps, "MSE" of the paper of 2025."""

    key, label, percent = "mse_100", "MSE_100", 100


@metric
class Ptc33(_Ptc):
    """Items removed after a third of the steps, of all K items."""

    key, label, percent = "ptc_33", "PTC_33", 33


@metric
class Ptc66(_Ptc):
    """Items removed after two thirds of the steps, of all K items."""

    key, label, percent = "ptc_66", "PTC_66", 66


@metric
class Ptc100(_Ptc):
    """Items removed after all steps, of all K items."""

    key, label, percent = "ptc_100", "PTC_100", 100
