"""docs/concepts/metrics.md has every registered metric, with unit and direction of its class."""

import re
from pathlib import Path

import pytest

from mjforage.mission.scoring import METRICS, describe

FOLDER = Path(__file__).parents[3] / "docs" / "concepts"
PAGE = (FOLDER / "metrics.md").read_text("utf-8")
ROWS = re.findall(
    r"^\| `(\w+)` \| ([^|]+) \| ([^|]+) \| ([↑↓–]) \| ([^|]+) \|$", PAGE, re.MULTILINE
)
SIGNS = {1: "↑", -1: "↓", 0: "–"}


def test_every_metric_has_one_row() -> None:
    ours = [key for key in METRICS.names() if METRICS.find(key).__module__.startswith("mjforage.")]
    assert sorted(key for key, *_ in ROWS) == sorted(ours)


@pytest.mark.parametrize(("key", "unit", "better"), [(row[0], row[1], row[3]) for row in ROWS])
def test_a_row_has_unit_and_direction_of_the_class(key: str, unit: str, better: str) -> None:
    shown = describe(key)
    assert (unit, better) == (shown.unit or "–", SIGNS[shown.better])


def test_every_section_of_metrics_has_equation_and_limits() -> None:
    """From one table of metrics to the next: an equation, and what it cannot say."""
    parts = PAGE.split("| metric | unit | range | better | undefined |")
    assert len(parts) > 8
    for after in parts[1:]:
        assert "$$" in after and "Cannot say:" in after, after[:200]


def test_all_pictures_are_on_the_page() -> None:
    shown = re.findall(r"\]\((metrics-\w+\.svg)\)", PAGE)
    assert sorted(shown) == sorted(file.name for file in FOLDER.glob("metrics-*.svg"))
