"""Skill and calibration of a policy's forecasts of where items are."""

from mjforage import metrics
from mjforage.mission.scoring.known import metric
from mjforage.mission.scoring.metric import Batch, FloatArray, Metric


@metric
class BrierSkill(Metric):
    """Skill of the forecasts which nodes hold an item, over always saying how many do: 1 is
    perfect, 0 no better.

    1 - BS / (o (1 - o)) (Brier 1950; Murphy 1973); undefined for policies that forecast nothing.
    """

    key, label, better, compared, drawn = "brier_skill", "Brier_skill", 1, False, False
    least, most = 0.0, 1.0  # below 0: worse than nothing, which intervals take for its worst

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) over all its steps."""
        return metrics.brier_skill(batch.log.forecasts)


@metric
class CalibrationError(Metric):
    """Difference between the forecast probability that a node holds an item and the frequency
    with which it does, mean over ten bins of all nodes.

    Naeini, Cooper and Hauskrecht, AAAI 2015; undefined for policies that forecast nothing.
    """

    key, label, better, digits = "calibration_error", "Calibration_error", -1, 4
    compared, drawn = False, False
    least, most = 0.0, 1.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) over all its steps."""
        return metrics.calibration_error(batch.log.forecasts)


@metric
class Reliability(Metric):
    """Reliability of the forecasts which nodes hold an item: mean squared difference between
    their probability and the frequency of items, over ten bins; 0 is calibrated.

    Murphy 1973, the first part of the Brier score.
    """

    key, label, better, digits = "reliability", "Reliability", -1, 4
    compared, drawn = False, False
    least, most = 0.0, 1.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) over all its steps."""
        return metrics.reliability(batch.log.forecasts)
