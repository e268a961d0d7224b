import math

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.physics.validation import Finding, Measure, repeats, run_checks
from mjforage.physics.validation.finding import at_most, near, near_share, shown, within


def test_limits_belong_to_the_range() -> None:
    assert at_most("x", 2.0, 2.0).passed and not at_most("x", np.nextafter(2.0, 3.0), 2.0).passed
    assert within("x", 1.0, 1.0, 2.0).passed and not within("x", 0.99, 1.0, 2.0).passed
    assert near("x", 1.1, 1.0, 0.2).passed and not near("x", 0.7, 1.0, 0.2).passed
    assert near_share("x", -2.1, -2.0, 0.1).passed and not near_share("x", 2.0, -2.0, 0.1).passed


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_fails(value: float) -> None:
    assert not within("x", value, 0.0, 1.0).passed
    assert at_most("x", value, 1.0).passed == (value == -math.inf)


def test_strain_is_one_at_a_limit() -> None:
    assert within("x", 3.0, 1.0, 3.0).strain == near("x", 1.0, 2.0, 1.0).strain == 1.0
    assert within("x", 2.0, 1.0, 3.0).strain == 0.0
    assert at_most("x", 1.0, 4.0).strain == 0.25
    assert at_most("x", 0.0, 0.0).strain == 0.0 < at_most("x", 1.0, 0.0).strain
    assert Measure("x", math.nan, 0.0, 1.0, "").strain == math.inf


def test_a_finding_fails_with_one_of_its_measures() -> None:
    good, tight, bad = at_most("a", 0.0, 1.0), at_most("b", 0.9, 1.0), at_most("c", 1.1, 1.0)
    assert Finding("n", "1", "", "", (good, tight)).status == "passed"
    assert Finding("n", "1", "", "", (good, tight)).worst is tight
    assert Finding("n", "1", "", "", (good, bad, tight)).status == "failed"
    assert Finding("n", "1", "", "", (good, bad, tight)).worst is bad
    assert Finding("n", "1", "", "", ()).status == "does not apply"


def test_numbers_and_limits_in_words() -> None:
    assert [shown(v) for v in (0.0, 1234.5678, 1e-9, math.nan)] == ["0", "1235", "1.0e-09", "nan"]
    assert at_most("x", 1.0, 2.0).limit == "at most 2"
    assert Measure("x", 1.0, 3.0, math.inf, "").limit == "at least 3"
    assert within("x", 1.0, 0.5, 2.0).limit == "0.5 to 2"


def test_unknown_checks_and_numbers_of_runs_are_refused() -> None:
    with pytest.raises(UserError, match=r"--check zigzg: unknown; did you mean zigzag\?"):
        run_checks(["zigzg"])
    with pytest.raises(UserError, match=r"--check moon: unknown; choose rest, energy, straight"):
        run_checks(["moon"])
    for runs in (0, -3, 10**9):
        with pytest.raises(UserError, match=f"--runs {runs}: give 1 to 100000"):
            run_checks(["rest"], runs)


def test_progress_counts_checks_and_batches_of_long_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(repeats, "RUN_S", 5.0)
    seen: list[tuple[int, int]] = []
    run_checks(["endurance", "speeds"], 11, lambda done, total: seen.append((done, total)))
    assert seen == [(0, 3), (1, 3), (2, 3), (3, 3)]
