"""Make single faults; their checks have to fail: `python -m tests.mutants [NAME ...]`.

Faults stand in the TOML files of this folder. Each is made in a copy of the repository in a
temporary folder, where its check is run, once all checks have passed there without a fault. Exit
code 1 if one survives.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import chain, groupby, pairwise
from pathlib import Path
from queue import SimpleQueue

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
# Mutation tests: single faults, each of which a test notices

`make mutants` makes each fault alone, in a copy of the repository, and runs its check: a test that
must fail. Continuous integration does so with every fifteenth, others after each commit. The
faults are data, `tests/mutants/*.toml`. Each names its place by function and text, and a test sees
to it that this place still exists. The check of each stands beside it there.
"""
EVERY = 15
_HEAD = """
## {topic}

| mutant | fault |
|---|---|
"""


def page(mutants: Iterable[Mutant]) -> str:
    """The page of all mutants, file by file."""
    parts = [_PAGE]
    for topic, those in groupby(mutants, key=lambda mutant: mutant.topic):
        parts.append(_HEAD.format(topic=topic.capitalize()))
        for mutant in those:
            parts.append(f"| `{mutant.name}` | {mutant.fault} |\n")
    return "".join(parts)


def run_checks(checks: Sequence[str], copy: Path) -> tuple[int, list[str]]:
    """Exit code and lines of checks, all plain or none, in the copy as it is."""
    # Without the compiler numpy warns of the overflow that hashes are made of.
    quiet = ("--no-header", "--tb=line", "-W", "ignore:overflow:RuntimeWarning")
    plugins = ("-p", "no:xdist", "-p", "no:cacheprovider")
    plain = {"NUMBA_DISABLE_JIT": "1"} if _is_plain(checks[0]) else {}
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-x", *plugins, *quiet, *checks],
        cwd=copy,
        env=os.environ | {"PYTHONPATH": str(copy)} | plain,
        capture_output=True,
        text=True,
        check=False,
        timeout=LONGEST_S * len(checks),
    )
    return done.returncode, (done.stdout.strip() or done.stderr.strip() or "?").splitlines()


def _is_plain(check: str) -> bool:
    return check.startswith(PLAIN)


def copied(copy: Path) -> Path:
    """A copy of the repository."""
    for name in COPIED:
        shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy2(ROOT / "pyproject.toml", copy)
    return copy


def faults_without(checks: Iterable[str], copy: Path) -> list[str]:
    """What is wrong with checks where no fault was made, one process for those of a kind."""
    found = [
        run_checks(list(dict.fromkeys(those)), copy)
        for _, those in groupby(sorted(checks, key=_is_plain), key=_is_plain)
    ]
    return ["\n".join(["broke without a fault:", *said[-5:]]) for code, said in found if code]


def run_mutant(mutant: Mutant, copy: Path) -> str:
    """Spoil the copy, run the check and put the copy right again; what came of it."""
    path, spoilt = mutant.spoilt(copy)
    text, time = path.read_text(encoding="utf-8"), path.stat().st_mtime_ns
    path.write_text(spoilt, encoding="utf-8")
    try:
        code, said = run_checks([mutant.check], copy)
    finally:
        path.write_text(text, encoding="utf-8")
        os.utime(path, ns=(time, time))
    return f"{ {PASSED: 'SURVIVED', FAILED: 'caught'}.get(code, f'broke ({code})') }: {said[-1]}"


def run_all(chosen: list[Mutant], jobs: int) -> int:
    """Run mutants in so many copies, and return how many were not caught."""
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder, ThreadPoolExecutor(jobs) as pool:
        copies = [copied(Path(folder, str(job))) for job in range(jobs)]
        ends = [len(chosen) * job // jobs for job in range(jobs + 1)]
        shares = [[one.check for one in chosen[a:b]] for a, b in pairwise(ends)]
        if broken := [*chain.from_iterable(pool.map(faults_without, shares, copies))]:
            sys.exit("\n".join(broken))
        free = SimpleQueue[Path]()
        for copy in copies:
            free.put(copy)

        def run(mutant: Mutant) -> str:
            copy = free.get()
            try:
                return run_mutant(mutant, copy)
            finally:
                free.put(copy)

        survived = 0
        for mutant, found in zip(chosen, pool.map(run, chosen), strict=True):
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
    survived = run_all(sorted(chosen, key=lambda mutant: mutant.check), words.jobs)
    sys.stdout.write(f"{len(chosen) - survived} of {len(chosen)} caught\n")
    sys.exit(bool(survived))


if __name__ == "__main__":
    main()
