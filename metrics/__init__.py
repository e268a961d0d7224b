"""Metrics of sequential cooperation between teams, on plain arrays and an event table.

Nothing here knows vessels, graphs or files: any domain where one team finds tasks and another
serves them can be measured. The equations are those of the paper's section "Metrics
Definition"; statistics over episodes come beside them.

| metric | function | paper |
|---|---|---|
| events of every item | `EventTable`, `counts_by_step` | |
| Percentage of Target Achieved | `pta_series` | Primary metrics, PTA |
| model error (RMSE) | `model_error` | Primary metrics, RMSE |
| Normalised Time to X | `nt` | Primary metrics, NT_X |
| Throughput | `throughput` | Primary metrics, Throughput |
| Mean Idleness, Idleness Reduction Rate | `mean_idleness`, `irr` | Primary metrics, MI, IRR |
| Discovery-to-Service Latency | `mean_dsl` | Inter-team metrics, DSL |
| Inter-Team Temporal Lag | `itl`, `itl_level` | Inter-team metrics, ITL |
| Cooperative Success Ratio | `csr_series` | Inter-team metrics, CSR |
| Sensitivity Slope | `sensitivity_slope`, `bootstrap_sensitivity` | Inter-team metrics, CSSC |
| sensitivity regimes, break point | `two_segment_fit` | Inter-team metrics, CSSC |
| Gini index of `contributions` | `gini`, `team_gini_series` | Intra-team metrics, Gini |
| Coverage Overlap | `coverage_overlap` | Intra-team metrics, CO |
| Marginal Contribution | `marginal_contribution`, `paired_contribution` | Intra-team metrics, MC |
| forecasts: Brier score and skill | `brier`, `brier_skill`, `base_rate` | |
| forecasts: their calibration | `reliability`, `calibration_error` | |
| age of information, of positions | `age_of_information`, `position_age` | |
| maps of several owners | `unlikeness` | |
| contacts, delay of news | `contact_share`, `handover` | |
| mean, IQM | `mean`, `iqm`, `count` | |
| standard error | `sem`, `stratified_sem`, `half_width_95` | tables (1.96 SEM) |
| time until a share is collected, over episodes | `clearing_time`, `median_time`, `never_share` | |
| interval of a mean, mean of the worst 5 % | `mean_interval`, `worst_mean` | |
| paired differences, one or a family | `compared`, `episodes_needed` | |
| two policies, run by run | `probability_of_improvement` | |
| several tasks at once | `normalised`, `resampled_means`, `performance_profile` | |
| quality against cost | `pareto_front` | |

Bad arguments raise ValueError. Undefined values are NaN and are left out of the statistics.
"""

from mjforage.metrics.aggregation import (
    normalised,
    pareto_front,
    performance_profile,
    resampled_means,
)
from mjforage.metrics.calibration import (
    BINS,
    base_rate,
    brier,
    brier_skill,
    calibration_error,
    reliability,
)
from mjforage.metrics.clearing import clearing_time, median_time, never_share
from mjforage.metrics.comparison import (
    FEWEST,
    Family,
    compared,
    episodes_needed,
    probability_of_improvement,
)
from mjforage.metrics.events import NEVER, NOBODY, EventTable, counts_by_step
from mjforage.metrics.information import (
    age_of_information,
    contact_share,
    handover,
    position_age,
    unlikeness,
)
from mjforage.metrics.inter_team import csr_series, itl, itl_level, mean_dsl
from mjforage.metrics.intervals import Interval, mean_interval, worst_mean
from mjforage.metrics.intra_team import (
    contributions,
    coverage_overlap,
    gini,
    marginal_contribution,
    team_gini_series,
)
from mjforage.metrics.marginal import paired_contribution
from mjforage.metrics.model_error import model_error
from mjforage.metrics.primary import irr, mean_idleness, nt, pta_series, throughput
from mjforage.metrics.sensitivity import (
    Line,
    SensitivityIntervals,
    TwoSegments,
    bootstrap_sensitivity,
    sensitivity_slope,
    two_segment_fit,
)
from mjforage.metrics.statistics import count, half_width_95, iqm, mean, sem, stratified_sem

__all__ = [
    "BINS",
    "FEWEST",
    "NEVER",
    "NOBODY",
    "EventTable",
    "Family",
    "Interval",
    "Line",
    "SensitivityIntervals",
    "TwoSegments",
    "age_of_information",
    "base_rate",
    "bootstrap_sensitivity",
    "brier",
    "brier_skill",
    "calibration_error",
    "clearing_time",
    "compared",
    "contact_share",
    "contributions",
    "count",
    "counts_by_step",
    "coverage_overlap",
    "csr_series",
    "episodes_needed",
    "gini",
    "half_width_95",
    "handover",
    "iqm",
    "irr",
    "itl",
    "itl_level",
    "marginal_contribution",
    "mean",
    "mean_dsl",
    "mean_idleness",
    "mean_interval",
    "median_time",
    "model_error",
    "never_share",
    "normalised",
    "nt",
    "paired_contribution",
    "pareto_front",
    "performance_profile",
    "position_age",
    "probability_of_improvement",
    "pta_series",
    "reliability",
    "resampled_means",
    "sem",
    "sensitivity_slope",
    "stratified_sem",
    "team_gini_series",
    "throughput",
    "two_segment_fit",
    "unlikeness",
    "worst_mean",
]
