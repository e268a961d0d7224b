"""Make single faults; their checks have to fail: `python -m tests.mutants [NAME ...]`.

Faults stand in the TOML files of this folder. Each is made in a copy of the repository in a
temporary folder, where its check is run, once it has passed there without a fault. Exit code 1 if
one survives.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import groupby, pairwise
from pathlib import Path

from tests.mutants.faults import PACKAGE, ROOT, Mutant, mutants

COPIED = (PACKAGE, "models", "tests", "docs", "examples")
_PHYSICS = "tests/mjforage/physics"
PLAIN = (
    *(f"{_PHYSICS}/hydrodynamics/", f"{_PHYSICS}/dynamics/test_touch"),
    *(f"{_PHYSICS}/dynamics/test_period_monitor", f"{_PHYSICS}/positioning/test_white"),
    f"{_PHYSICS}/validation/test_checks.py::test_check[mouth]",
)
"""Beginnings of checks that take less time without the compiler than it takes, without MuJoCo."""
PASSED, FAILED = 0, 1  # exit codes of a check; anything else: it could not be run
LONGEST_S = 900.0
_PAGE = """<!-- Written by `python -m tests.mutants --page docs/mutants.md`. -->
# Mutation tests: single faults, and what notices them

`make mutants` makes each fault alone, in a copy of the repository, and runs its check: a test that
must fail. Continuous integration does so with every fifteenth, others after each commit. The
faults are data, `tests/mutants/*.toml`. Each names its place by function and text, and a test sees
to it that this place still exists.
"""
EVERY = 15
_HEAD = """
## {topic}

| mutant | fault | check |
|---|---|---|
"""


def page(mutants: Iterable[Mutant]) -> str:
    """The page of all mutants, file by file."""
    parts = [_PAGE]
    for topic, those in groupby(mutants, key=lambda mutant: mutant.topic):
        parts.append(_HEAD.format(topic=topic.capitalize()))
        for mutant in those:
            check = mutant.check.split("/")[-1].replace("::", " ")
            parts.append(f"| `{mutant.name}` | {mutant.fault} | `{check}` |\n")
    return "".join(parts)


def run_check(check: str, copy: Path) -> tuple[int, str]:
    """Exit code and last line of a check in the copy as it is."""
    # Without the compiler numpy warns of the overflow that hashes are made of.
    quiet = ("--no-header", "--tb=line", "-W", "ignore:overflow:RuntimeWarning")
    plugins = ("-p", "no:xdist", "-p", "no:cacheprovider")
    plain = {"NUMBA_DISABLE_JIT": "1"} if check.startswith(PLAIN) else {}
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-x", *plugins, *quiet, check],
        cwd=copy,
        env=os.environ | {"PYTHONPATH": str(copy)} | plain,
        capture_output=True,
        text=True,
        check=False,
        timeout=LONGEST_S,
    )
    return done.returncode, (done.stdout.strip() or done.stderr.strip() or "?").splitlines()[-1]


def run_mutant(mutant: Mutant, copy: Path) -> str:
    """Spoil the copy, run the check and put the copy right again; what came of it."""
    path, spoilt = mutant.spoilt(copy)
    text, time = path.read_text(encoding="utf-8"), path.stat().st_mtime_ns
    path.write_text(spoilt, encoding="utf-8")
    try:
        code, said = run_check(mutant.check, copy)
    finally:
        path.write_text(text, encoding="utf-8")
        os.utime(path, ns=(time, time))
    return f"{ {PASSED: 'SURVIVED', FAILED: 'caught'}.get(code, f'broke ({code})') }: {said}"


def run_all(chosen: list[Mutant]) -> int:
    """Run mutants in a copy of their own, and return how many were not caught."""
    survived = 0
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        copy = Path(folder)
        for name in COPIED:
            shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy2(ROOT / "pyproject.toml", copy)
        sound = cache(lambda check: run_check(check, copy))
        for mutant in chosen:
            code, said = sound(mutant.check)
            found = f"broke without a fault: {said}" if code else run_mutant(mutant, copy)
            survived += not found.startswith("caught")
            sys.stdout.write(f"{mutant.name} ({mutant.fault}), {mutant.check}: {found}\n")
            sys.stdout.flush()
    return survived


def main() -> None:
    """Run the mutants that are named and say what each came to."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    parser.add_argument("name", nargs="*", help="mutants to run, all by default")
    parser.add_argument("--page", type=Path, help="file to write the list to; nothing is run")
    parser.add_argument("--jobs", type=int, default=1, help="copies of the repository at work")
    parser.add_argument(
        "--some", type=int, help=f"every {EVERY}th mutant, from this one of the first"
    )
    words = parser.parse_args()
    known = {mutant.name: mutant for mutant in mutants()}
    if words.page:
        words.page.write_text(page(known.values()), encoding="utf-8")
        return
    if unknown := sorted(set(words.name) - set(known)):
        sys.exit(f"mutants: {', '.join(unknown)} unknown; docs/mutants.md has their names")
    chosen = [known[name] for name in words.name or known]
    if words.some is not None:
        chosen = chosen[words.some % EVERY :: EVERY]
    chosen.sort(key=lambda mutant: mutant.check)  # each of them once without a fault
    ends = [len(chosen) * k // words.jobs for k in range(words.jobs + 1)]
    with ThreadPoolExecutor(words.jobs) as pool:
        shares = (chosen[begin:end] for begin, end in pairwise(ends))
        survived = sum(pool.map(run_all, shares))
    sys.stdout.write(f"{len(chosen) - survived} of {len(chosen)} caught\n")
    sys.exit(bool(survived))


if __name__ == "__main__":
    main()
