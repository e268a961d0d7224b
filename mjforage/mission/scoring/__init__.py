"""The metrics of a mission: a class each, with name, unit, direction and formula.

`metric` says what one is, `known` which there are, `scoring` takes them from a batch; every other
file here holds metrics. A file that is put beside them is found without an edit elsewhere; a class
in a package of your own is taken by the name of its entry point `mjforage.metrics`, or by
`package.module:Name`.
"""

import importlib
import pkgutil

from mjforage.mission.scoring.known import (
    METRICS,
    chosen_metrics,
    describe,
    import_specs_of,
    metric,
)
from mjforage.mission.scoring.metric import Batch, Description, Metric, StepView, description
from mjforage.mission.scoring.scoring import Scorer, Scores, score

__all__ = [
    "METRICS",
    "Batch",
    "Description",
    "Metric",
    "Scorer",
    "Scores",
    "StepView",
    "chosen_metrics",
    "describe",
    "description",
    "import_specs_of",
    "metric",
    "score",
]

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")
