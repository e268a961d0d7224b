"""Does every single fault of the physics fail its check? `python -m tests.mutants [NAME ...]`.

Faults stand in the TOML files of this folder. Each is made in a copy of the repository in a
temporary folder, where its check is run, once it has passed there on the physics as it is. It takes
about half an hour on one core, most of it compiling. Exit code 1 if one survives.
"""

import argparse
import sys
import tempfile
from pathlib import Path

from tests.mutants.faults import Mutant, mutants
from tests.mutants.running import Outcome, copied, is_plain, run_check, run_mutant

_PAGE = """<!-- Written by `python -m tests.mutants --out docs/mutants.md`. -->
# Single faults of the physics, and what notices them

Each is made alone, in a copy of the repository; then its check is run: one of `mjforage validate`
where there is one, a test else. The faults are data, `tests/mutants/*.toml`; a test sees to it that
each still fits its file.

| mutant | fault | check | |
|---|---|---|---|
"""


def _say(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def _chosen(names: list[str]) -> list[Mutant]:
    """Mutants by name, all by default; ends the process if there is none of a name."""
    known = {mutant.name: mutant for mutant in mutants()}
    if unknown := [name for name in names if name not in known]:
        sys.exit(f"mutants: {', '.join(unknown)} unknown; --list names them")
    return [known[name] for name in names or known]


def _row(mutant: Mutant, outcome: Outcome) -> str:
    """A row of the table in Markdown."""
    check = mutant.check.split("/")[-1].replace("::", " ")
    return f"| `{mutant.name}` | {mutant.fault} | `{check}` | {outcome.verdict} |"


def _run(mutant: Mutant, copy: Path, passed: set[str]) -> Outcome:
    """Run a mutant; before its check's first, on the physics as it is.

    Ends the process if the check fails without a fault.
    """
    if mutant.check not in passed:
        outcome = run_check(mutant, copy)
        if outcome.code:
            sys.exit(f"mutants: {mutant.check} fails without a fault ({outcome.words})")
        passed.add(mutant.check)
    return run_mutant(mutant, copy)


def main() -> None:
    """Run the mutants that are named and print a table."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    parser.add_argument("name", nargs="*", help="mutants to run, all by default")
    parser.add_argument("--list", action="store_true", help="name them and run nothing")
    parser.add_argument("--out", type=Path, help="file to write the page with the table to")
    words = parser.parse_args()
    if words.out and words.name:
        sys.exit("mutants: --out is for the whole table; give no names with it")
    chosen = _chosen(words.name)
    if words.list:
        for mutant in chosen:
            _say(f"{mutant.name}: {mutant.fault} ({mutant.check})")
        return
    rows: list[str] = []
    survived = 0
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        copies = {plain: copied(Path(folder), plain) for plain in (False, True)}
        passed: set[str] = set()
        for mutant in chosen:
            outcome = _run(mutant, copies[is_plain(mutant.check)], passed)
            survived += outcome.verdict != "caught"
            rows.append(_row(mutant, outcome))
            _say(f"{rows[-1]} {outcome.words}")
    if words.out:
        words.out.write_text(_PAGE + "\n".join(rows) + "\n", encoding="utf-8")
    _say(f"{len(chosen) - survived} of {len(chosen)} caught")
    sys.exit(1 if survived else 0)


if __name__ == "__main__":
    main()
