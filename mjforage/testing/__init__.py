"""Conformance checks that ours pass: of policies, environments, algorithms and parts of your own.

Call them in your tests; what fails is a `ConformanceError` of one sentence:

    from mjforage.testing import check_policy

    def test_north() -> None:
        check_policy("my_policies:North(heading=2)", scenario="comb-port")
"""

from mjforage.testing.algorithm_checks import check_algorithm
from mjforage.testing.conformance import ConformanceError
from mjforage.testing.environment_checks import check_environment
from mjforage.testing.part_checks import check_metric, check_observation, check_reward
from mjforage.testing.policy_checks import check_policy

__all__ = [
    "ConformanceError",
    "check_algorithm",
    "check_environment",
    "check_metric",
    "check_observation",
    "check_policy",
    "check_reward",
]
