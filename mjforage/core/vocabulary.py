"""The name, one-line definition, precision and better direction of every metric in a run folder."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Metric:
    """How one summary key is shown. `label` marks a subscript by an underscore, as in ``PTA_D``."""

    key: str
    label: str
    definition: str
    digits: int  # decimals shown
    better: int  # +1 more is better, -1 less is better, 0 neither
    unit: str = ""

    @property
    def plain(self) -> str:
        """Label for a terminal."""
        return self.label.replace("_", " ")


METRICS: dict[str, Metric] = {
    metric.key: metric
    for metric in (
        Metric("pta_d", "PTA_D", "items discovered by anyone, of all K items", 2, 1, "%"),
        Metric("pta_c", "PTA_C", "items removed, of all K items", 2, 1, "%"),
        Metric(
            "rmse",
            "RMSE",
            "root mean squared difference over the navigable nodes between the true and the "
            "believed item counts, both smoothed by a Gaussian of one node",
            4,
            -1,
        ),
        Metric(
            "rmse_columns",
            "RMSE_columns",
            "the same difference taken per map column, land included, and averaged over the "
            "columns: the number that the paper printed",
            4,
            -1,
        ),
        Metric(
            "nt50", "NT_50", "first step with half of the items removed, over T; never = 1", 3, -1
        ),
        Metric(
            "nt90", "NT_90", "first step with 90 % of the items removed, over T; never = 1", 3, -1
        ),
        Metric(
            "throughput", "Throughput", "items removed per forager and step of the horizon", 3, 1
        ),
        Metric(
            "throughput_scouts",
            "Throughput_scouts",
            "items discovered per scout and step of the horizon",
            3,
            1,
        ),
        Metric("mi_final", "MI_final", "mean idleness of the navigable nodes at the end", 3, -1),
        Metric("mi_mean", "MI_mean", "mean idleness of the navigable nodes, time mean", 3, -1),
        Metric("irr_mean", "IRR_mean", "fall of the mean idleness per step, time mean", 5, 1),
        Metric(
            "dsl",
            "DSL",
            "steps from a scout's discovery of an item to its removal, over T",
            3,
            -1,
        ),
        Metric(
            "itl",
            "ITL",
            "steps between the largest single-step rises of PTA_D and of PTA_C, over T",
            3,
            0,
        ),
        Metric(
            "itl_level",
            "ITL_level",
            "steps between the first maxima of PTA_D and of PTA_C themselves, over T",
            3,
            0,
        ),
        Metric(
            "csr", "CSR", "removed items that a scout had discovered first, of all removed", 3, 1
        ),
        Metric(
            "gini_foragers",
            "Gini_foragers",
            "inequality of the items removed per forager; 0 is even",
            3,
            -1,
        ),
        Metric(
            "gini_scouts",
            "Gini_scouts",
            "inequality of the items discovered per scout; 0 is even",
            3,
            -1,
        ),
        Metric(
            "co_scouts",
            "CO_scouts",
            "nodes that at least two scouts see, of those that one sees; time mean",
            3,
            -1,
        ),
        Metric(
            "co_foragers",
            "CO_foragers",
            "nodes that at least two foragers see, of those that one sees; time mean",
            3,
            -1,
        ),
        Metric(
            "length", "Length", "steps until the last item was removed, at most T", 1, -1, "steps"
        ),
        Metric("cleared", "Cleared", "fraction of the episodes that ended with no item left", 2, 1),
    )
}
"""Every metric of `episodes.parquet`, in the order of the tables."""

HEADLINE = ("pta_d", "pta_c", "rmse", "nt90", "csr", "gini_foragers", "length")
COMPARED = ("pta_d", "pta_c", "rmse", "nt50", "nt90", "throughput", "csr", "mi_mean", "length")

SERIES = (
    "pta_d",
    "pta_c",
    "rmse",
    "rmse_columns",
    "mi",
    "irr",
    "csr",
    "gini_foragers",
    "gini_scouts",
    "co_scouts",
    "co_foragers",
)
"""Columns of `steps.parquet` that are logged per step."""


def describe(key: str) -> Metric:
    """Metric of a key; one that this version does not know is shown under its own key."""
    return METRICS.get(key) or Metric(key, key.replace("_", " "), "no description", 4, 0)
