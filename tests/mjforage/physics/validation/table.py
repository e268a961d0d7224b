"""The table of docs/physics.md: of each check the measure that is nearest to its limit.

`python -m tests.mjforage.physics.validation.table --json FILE`, by `make evidence`.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from tests.mjforage.physics.validation import (
    contact_checks,
    drift_checks,
    manoeuvre_checks,
    mission_checks,
    motion_checks,
    random_minutes,
    repeat_checks,
    weather_checks,
)
from tests.mjforage.physics.validation.measures import CHECKS, utilisation

MODULES = (
    *(contact_checks, drift_checks, manoeuvre_checks, mission_checks, motion_checks),
    *(random_minutes, repeat_checks, weather_checks),
)
"""Modules that register checks."""


def _place(name: str) -> tuple[int, str]:
    number = CHECKS[name].number
    return int(number.rstrip("abcd")), number


def main(words: Sequence[str]) -> None:
    """Run all checks and write a row of each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, required=True)
    rows = []
    for name in sorted(CHECKS, key=_place):
        number, measures = CHECKS[name]
        worst = max(measures(), key=lambda measure: (not measure.passed, utilisation(measure)))
        result = "passed" if worst.passed else "failed"
        rows.append([number, name, worst.what, worst.value, worst.unit, worst.limit, result])
    parser.parse_args(words).json.write_text(json.dumps(rows, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
