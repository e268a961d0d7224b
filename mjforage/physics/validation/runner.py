"""Running checks one after the other, whatever happens in them."""

import math
from collections.abc import Callable, Sequence

from mjforage.base.errors import UserError
from mjforage.physics.simulation import InstabilityError
from mjforage.physics.validation import all_checks
from mjforage.physics.validation.finding import Finding, Measure
from mjforage.physics.validation.known_checks import Check, check_names, find_check

MOST_RUNS = 100_000
_Tick = Callable[[], None]


def run_checks(
    names: Sequence[str] = (),
    runs: int = all_checks.repeats.RUNS,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> list[Finding]:
    """Run checks by name, all by default, in the order of the report.

    Parameters
    ----------
    runs : long runs of the check `endurance`
    progress : called with (done, total) after each check and each batch of long runs

    Raises
    ------
    UserError
        If there is no such check, or a number is out of range. A check in which the simulation
        becomes unstable has failed; that is no error.
    """
    if not 1 <= runs <= MOST_RUNS:
        raise UserError(f"--runs {runs}: give 1 to {MOST_RUNS}")
    wanted = {name: find_check(name) for name in names or check_names()}
    ordered = [wanted[name] for name in check_names() if name in wanted]
    long = all_checks.repeats.endurance in ordered
    total = len(ordered) - long + long * math.ceil(runs / all_checks.repeats.BATCH)
    done = 0

    def tick() -> None:
        nonlocal done
        done += 1
        progress(done, total)

    progress(0, total)
    return [_run(check, runs, tick) for check in ordered]


def _run(check: Check, runs: int, tick: _Tick) -> Finding:
    try:
        if check is all_checks.repeats.endurance:
            return check.finding((all_checks.repeats.long_runs(runs, tick), ()))
        found = check()
        tick()
        return found
    except InstabilityError as error:
        return check.finding(((Measure(str(error), math.nan, 0.0, 0.0, ""),), ()))
