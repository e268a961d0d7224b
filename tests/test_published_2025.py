"""The comparison with another program's figures can fail."""

import pytest

from tests.published_2025 import Figures, verdict

OURS: Figures = {("comb_port", "walk-2025", "mse_33"): (0.03, 0.001)}


@pytest.mark.parametrize(
    ("theirs", "scores", "holds"),
    [
        (OURS, [0.5] * 9 + [2.5], True),
        (OURS, [0.5] * 8 + [2.5] * 2, False),
        (OURS, [0.5] * 99 + [-3.1], False),
        (OURS, [-2.9], False),
        (OURS, [], False),
        (OURS | {("isles", "walk-2025", "mse_33"): (0.03, 0.001)}, [0.5] * 10, False),
    ],
)
def test_it_holds_within_three_and_nine_of_ten_within_two(
    theirs: Figures, scores: list[float], holds: bool
) -> None:
    words, found = verdict(OURS, theirs, scores)
    assert found == holds
    assert ("isles" in words) == (len(theirs) > 1)
