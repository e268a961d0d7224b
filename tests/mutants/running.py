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
PHYSICS = "tests/mjforage/physics"
PLAIN = (
    *(
        f"{PHYSICS}/hydrodynamics/",
        f"{PHYSICS}/dynamics/test_touch",
        f"{PHYSICS}/dynamics/test_watch",
    ),
    *(
        f"{PHYSICS}/dynamics/test_sensing",
        f"{PHYSICS}/validation/test_checks.py::test_check[mouth]",
    ),
)
"""Beginnings of checks that take less time than the kernels take to compile, without MuJoCo."""
PASSED, FAILED = 0, 1  # exit codes of a check; anything else: it could not be run
LONGEST_S = 900.0


@dataclass(frozen=True)
class Outcome:
    """What a check said."""

    code: int  # exit code
    words: str  # last line of the report

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
    return check.startswith(PLAIN)


def run_check(mutant: Mutant, copy: Path) -> Outcome:
    """Run a mutant's check on the copy as it is."""
    # Without the compiler numpy warns of the overflow that hashes are made of.
    quiet = ("-W", "ignore:overflow:RuntimeWarning")
    plugins = ("-p", "no:xdist", "-p", "no:cacheprovider")
    flags = ("-x", *plugins, "--no-header", "--tb=line", *quiet)
    words = [sys.executable, "-m", "pytest", *flags, mutant.check]
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
    return Outcome(done.returncode, lines[-1])


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
