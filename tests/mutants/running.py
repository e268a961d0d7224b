"""Running mutants, one after the other, on a copy of the repository."""

import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from tests.mutants.faults import PACKAGE, ROOT, Mutant
from tests.mutants.kernels import interpreted

COPIED = (PACKAGE, "models", "tests", "docs", "examples")
LEFT_OUT = shutil.ignore_patterns("__pycache__")
PHYSICS = "mjforage/physics"
PLAIN = frozenset({"wind-load", "mouth", "touch-speed", "energy-drawn", "added-mass", "ramming"})
"""Checks that take less time than the kernels take to compile, and so do the tests of `UNITS`."""
UNITS = ("hydrodynamics", "dynamics")
PASSED, FAILED = 0, 1  # exit codes of a check; anything else: it could not be run
LONGEST_S = 900.0
_VALIDATE = """
import sys
from mjforage.physics.validation import run_checks
(finding,) = run_checks(sys.argv[1:], runs=2)
failed = [measure for measure in finding.measures if not measure.passed]
for measure in failed[:1]:
    print(f"{measure.what}: {measure.value:.4g} {measure.unit}, {measure.limit}")
sys.exit(1 if failed else 0)
"""


@dataclass(frozen=True)
class Outcome:
    """What a check said."""

    code: int  # exit code
    words: str  # the first measure that failed, or the last line of the test's report

    @property
    def verdict(self) -> str:
        """Caught, survived, or that the check did not run."""
        return {PASSED: "SURVIVED", FAILED: "caught"}.get(self.code, f"broke ({self.code})")

    @property
    def passed(self) -> bool:
        """Whether the check found nothing."""
        return self.code == PASSED

    def without_fault(self) -> "Outcome":
        """The same, of a check that fails without a fault, which catches none."""
        return Outcome(-2, f"without a fault: {self.words}")


def copied(folder: Path, plain: bool) -> Path:
    """Copy what checks need into a folder of a folder, with the compiler or without."""
    copy = folder / ("plain" if plain else "compiled")
    for name in COPIED:
        shutil.copytree(ROOT / name, copy / name, ignore=LEFT_OUT)
    shutil.copy2(ROOT / "pyproject.toml", copy)
    if plain:
        interpreted(copy)
    return copy


def is_plain(check: str) -> bool:
    """Whether a check is run without the compiler."""
    return check in PLAIN or any(check.startswith(f"tests/{PHYSICS}/{room}/") for room in UNITS)


def run_check(mutant: Mutant, copy: Path) -> Outcome:
    """Run a mutant's check on the copy as it is."""
    if mutant.is_test:
        # Without the compiler numpy warns of the overflow that hashes are made of.
        quiet = ("-W", "ignore:overflow:RuntimeWarning")
        flags = (
            "-x",
            "-p",
            "no:xdist",
            "-p",
            "no:cacheprovider",
            "--no-header",
            "--tb=line",
            *quiet,
        )
        words = [sys.executable, "-m", "pytest", *flags, mutant.check]
    else:
        words = [sys.executable, "-c", _VALIDATE, mutant.check]
    done = subprocess.run(
        words,
        cwd=copy,
        env=os.environ | {"PYTHONPATH": str(copy)},
        capture_output=True,
        text=True,
        check=False,
        timeout=LONGEST_S,
    )
    lines = (done.stdout.strip() or done.stderr.strip() or "nothing said").splitlines()
    if not mutant.is_test and done.returncode == FAILED and "Traceback" in done.stderr:
        return Outcome(-1, done.stderr.strip().splitlines()[-1])
    return Outcome(done.returncode, lines[-1 if mutant.is_test else 0])


def run_mutant(mutant: Mutant, copy: Path) -> Outcome:
    """Spoil the copy, run the check, and put the copy right again."""
    path, spoilt = mutant.spoilt(copy)
    kept, time = path.read_text(encoding="utf-8"), path.stat().st_mtime_ns
    path.write_text(spoilt, encoding="utf-8")
    try:
        return run_check(mutant, copy)
    finally:
        path.write_text(kept, encoding="utf-8")
        os.utime(path, ns=(time, time))
