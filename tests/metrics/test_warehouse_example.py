"""The example runs, and its numbers are those of a possible warehouse."""

import io
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

EXAMPLE = Path(__file__).parents[2] / "examples" / "warehouse_metrics.py"


@pytest.fixture(scope="module")
def example() -> dict[str, Any]:
    return runpy.run_path(str(EXAMPLE))


def test_tables_name_every_metric(example: dict[str, Any]) -> None:
    page = io.StringIO()
    example["main"](runs=8, console=Console(file=page, width=120))
    for name in ("PTA fetched", "RMSE", "NT 90", "throughput", "idleness", "IRR", "DSL", "ITL"):
        assert name in page.getvalue()
    for name in ("CSR", "Gini carriers", "overlap", "marginal contribution", "break point"):
        assert name in page.getvalue()


def test_values_are_defined_bounded_and_repeatable(example: dict[str, Any]) -> None:
    rules = example["Rules"](roaming=0.5)
    first, second = example["evaluate"](rules, 5), example["evaluate"](rules, 5)
    for name, values in first.items():
        np.testing.assert_array_equal(values, second[name])
        assert np.isfinite(values).all(), name
        assert (values >= 0).all(), name
        assert (values <= (100 if "PTA" in name else 1)).all(), name


def test_one_locator_alone_cannot_find_as_much(example: dict[str, Any]) -> None:
    found = "PTA found, %"
    pair = example["evaluate"](example["Rules"](roaming=0.0), 10)[found]
    single = example["evaluate"](example["Rules"](roaming=0.0, locators=1), 10)[found]
    assert single.mean() < 0.8 * pair.mean()
