"""Does every single fault fail its check? `python -m tests.mutants [NAME ...]`.

Faults stand in the TOML files of this folder. Each is made in a copy of the repository in a
temporary folder, where its check is run, once it has passed there without a fault. Exit code 1 if
one survives.
"""

import argparse
import sys
import tempfile
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from itertools import groupby, pairwise
from pathlib import Path

from tests.mutants.faults import Mutant, mutants
from tests.mutants.running import Outcome, copied, is_plain, run_check, run_mutant

_PAGE = """<!-- Written by `python -m tests.mutants --page docs/mutants.md`. -->
# Mutation tests: single faults, and what notices them

`make mutants` makes each fault alone, in a copy of the repository, and runs its check: a test that
must fail. Continuous integration does so with a tenth of them, another one after each commit. The
faults are data, `tests/mutants/*.toml`. Each names its place by function and text, and a test sees
to it that this place still exists.
"""
_HEAD = """
## {room}

| mutant | fault | check |
|---|---|---|
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


def _row(mutant: Mutant) -> str:
    """A row of the table in Markdown."""
    check = mutant.check.split("/")[-1].replace("::", " ")
    return f"| `{mutant.name}` | {mutant.fault} | `{check}` |"


def page(mutants: Iterable[Mutant]) -> str:
    """The page of all mutants, room by room."""
    parts = [_PAGE]
    for room, those in groupby(mutants, key=lambda mutant: mutant.room):
        parts.append(_HEAD.format(room=room.capitalize()))
        parts += [f"{_row(mutant)}\n" for mutant in those]
    return "".join(parts)


def _run_all(chosen: list[Mutant]) -> dict[Mutant, Outcome]:
    """Run mutants one after the other; before a check's first, the check without a fault."""
    outcomes, sound = dict[Mutant, Outcome](), dict[str, Outcome]()
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        copies = {plain: copied(Path(folder), plain) for plain in (False, True)}
        for mutant in chosen:
            copy = copies[is_plain(mutant.check)]
            before = sound.get(mutant.check) or run_check(mutant, copy)
            sound[mutant.check] = before
            found = run_mutant(mutant, copy) if before.passed else before.without_fault()
            outcomes[mutant] = found
            _say(f"{found.verdict}: {mutant.name} ({mutant.fault}), {mutant.check}: {found.words}")
    return outcomes


def main() -> None:
    """Run the mutants that are named and say what each came to."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    parser.add_argument("name", nargs="*", help="mutants to run, all by default")
    parser.add_argument("--list", action="store_true", help="name them and run nothing")
    parser.add_argument("--page", type=Path, help="file to write the list to; nothing is run")
    parser.add_argument("--jobs", type=int, default=1, help="copies of the repository at work")
    parser.add_argument("--tenth", type=int, help="every tenth mutant, from this one of the first")
    words = parser.parse_args()
    if words.page:
        words.page.write_text(page(mutants()), encoding="utf-8")
        return
    chosen = _chosen(words.name)
    if words.tenth is not None:
        chosen = chosen[words.tenth % 10 :: 10]
    if words.list:
        for mutant in chosen:
            _say(f"{mutant.name}: {mutant.fault} ({mutant.check})")
        return
    by_check = sorted(chosen, key=lambda mutant: mutant.check)  # each of them once without a fault
    with ThreadPoolExecutor(words.jobs) as pool:
        runs = pool.map(_run_all, _shares(by_check, words.jobs))
        found = {mutant: outcome for done in runs for mutant, outcome in done.items()}
    survived = sum(outcome.verdict != "caught" for outcome in found.values())
    _say(f"{len(chosen) - survived} of {len(chosen)} caught")
    sys.exit(1 if survived else 0)


def _shares(chosen: list[Mutant], jobs: int) -> list[list[Mutant]]:
    """Mutants for each copy, one check's side by side."""
    ends = [len(chosen) * k // jobs for k in range(jobs + 1)]
    return [chosen[begin:end] for begin, end in pairwise(ends)]


if __name__ == "__main__":
    main()
