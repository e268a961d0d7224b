"""Error of the believed distribution of the items."""

from mjforage import metrics
from mjforage.mission.scoring.known import metric
from mjforage.mission.scoring.metric import FloatArray, Metric, StepView

WORST = 0.2
"""RMSE that intervals take for its worst [items/node]: a convention, as it has no end."""


def errors(view: StepView) -> tuple[FloatArray, FloatArray]:
    """RMSE over the nodes and per column, (open,) each."""
    mission = view.mission
    truth = view.of_open(mission.ledger.truth)
    belief = view.of_open(mission.knowledge.belief)
    return metrics.model_error(truth, belief, mission.setup.grid.navigable)


@metric
class ErrorOverNodes(Metric):
    """Root mean squared difference over the navigable nodes between the true and the believed item
    counts, both smoothed by a Gaussian of one node.

    Paper, "Primary metrics", RMSE.
    """

    key, label, better, digits = "rmse", "RMSE", -1, 4
    unit, top = "items/node", 0.0
    least, most = 0.0, WORST

    def at(self, view: StepView) -> FloatArray:
        """(open,) now."""
        return view.cached(errors)[0]


@metric
class ErrorPerColumn(Metric):
    """The same difference taken per map column, land included, and averaged over the columns: the
    number that the paper printed.
    """

    key, label, better, digits = "rmse_columns", "RMSE_columns", -1, 4
    unit, top = "items/node", 0.0
    compared, least, most = False, 0.0, 0.08  # a convention, as that of RMSE

    def at(self, view: StepView) -> FloatArray:
        """(open,) now."""
        return view.cached(errors)[1]
