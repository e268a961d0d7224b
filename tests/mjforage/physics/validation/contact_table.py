"""Contacts at top speed, of docs/physics.md: into a quay, and head on of any two hulls.

`python -m tests.mjforage.physics.validation.contact_table --json FILE`, by `make evidence`.
"""

import argparse
import itertools
import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from mjforage.physics.contact_trials import Impact, head_on, into_quay
from mjforage.physics.simulation import Integrator
from mjforage.physics.vessels import load_vessel
from tests.mjforage.physics.validation.runs import CASES, case_name


def impacts() -> Iterator[tuple[str, list[Impact]]]:
    """A line of words and the impact with each integrator."""
    for name, load in CASES:
        vessel = load_vessel(name)
        yield (
            f"{case_name(name, load)}, into a quay",
            [into_quay(vessel, integrator, load) for integrator in Integrator],
        )
    for (one, load), (other, more) in itertools.combinations_with_replacement(CASES, 2):
        fleet, loads = (load_vessel(one), load_vessel(other)), (load, more)
        yield (
            f"{case_name(one, load)}, and {case_name(other, more)}",
            [head_on(*fleet, integrator, loads) for integrator in Integrator],
        )


def main(words: Sequence[str]) -> None:
    """Write a row of each contact: speed, then depths, forces and rebounds, fast and reference."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, required=True)
    options, rows = parser.parse_args(words), []
    for label, found in impacts():
        depths, forces = [1e3 * i.depth_m for i in found], [i.force_n for i in found]
        rows.append([label, found[0].speed_mps, *depths, *forces, *(i.rebound for i in found)])
    options.json.write_text(json.dumps(rows, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
