"""Conformance checks for policies, algorithms and parts of your own.

Call them in your tests; what fails is a `ConformanceError` of one sentence:

    from mjforage.testing import check_policy

    def test_north() -> None:
        check_policy("my_policies:North(heading=2)", scenario="comb-port")
"""

from typing import TYPE_CHECKING, Any

from mjforage.base.extras import require
from mjforage.testing.conformance import ConformanceError
from mjforage.testing.part_checks import (
    check_metric,
    check_observation,
    check_positioning,
    check_reward,
)
from mjforage.testing.policy_checks import check_policy

if TYPE_CHECKING:
    from mjforage.testing.algorithm_checks import check_algorithm

__all__ = [
    "ConformanceError",
    "check_algorithm",
    "check_metric",
    "check_observation",
    "check_policy",
    "check_positioning",
    "check_reward",
]


def __getattr__(name: str) -> Any:
    """`check_algorithm`, which alone needs torch."""
    if name != "check_algorithm":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    require(name, "torch")
    from mjforage.testing.algorithm_checks import check_algorithm

    return check_algorithm
