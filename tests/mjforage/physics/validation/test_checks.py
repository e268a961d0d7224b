"""Every check of the physics passes; mutants hold that each of them notices a fault."""

import pytest

from tests.mjforage.physics.validation.measures import CHECKS, Measure, at_most, near, utilisation
from tests.mjforage.physics.validation.table import MODULES  # noqa: F401


@pytest.mark.parametrize("name", CHECKS)
def test_check(name: str) -> None:
    failed = [measure for measure in CHECKS[name].measures() if not measure.passed]
    assert not failed


def test_utilisation_is_one_at_a_limit_and_infinite_for_nan() -> None:
    assert near("x", 1.0, 2.0, 1.0) == Measure("x", 1.0, 1.0, 3.0)
    assert [utilisation(Measure("x", value, 1.0, 3.0)) for value in (1.0, 2.0, 3.0)] == [1, 0, 1]
    assert utilisation(at_most("x", 1.0, 4.0)) == 0.25
    assert utilisation(at_most("x", 0.0, 0.0)) == 0.0 < utilisation(at_most("x", 1.0, 0.0))
    assert utilisation(Measure("x", float("nan"), 0.0, 1.0)) == float("inf")
