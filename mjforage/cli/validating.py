"""`mjforage validate`."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich.table import Table

from mjforage.cli.console import FOLDER, app, bar, output, print_table, working

if TYPE_CHECKING:
    from mjforage.physics.validation import Finding

FAILED_CODE = 1


@app.command
def validate(
    *,
    out: Annotated[Path, FOLDER] = Path("runs/validation"),
    check: Annotated[tuple[str, ...], Parameter(name="--check", negative="")] = (),
    runs: int = 40,
) -> None:
    """Check the physics against closed forms and balances; exit code 1 if a check fails.

    Parameters
    ----------
    out
        Folder for report.html, validation.json and figures.
    check
        Run only this check, for example turning-circle; repeatable.
    runs
        Runs of 900 s in the check endurance.
    """
    from mjforage.physics.validation import run_checks
    from mjforage.view.validation import check_folder, write_validation

    check_folder(out)
    with bar("validate", "checks") as shown:
        findings = run_checks(check, runs, shown)
    with working("drawing the report"):
        path = write_validation(findings, out)
    print_table(_table(findings))
    output.print(f"report: {path}", soft_wrap=True)
    if any(finding.status == "failed" for finding in findings):
        sys.exit(FAILED_CODE)


def _table(findings: "list[Finding]") -> Table:
    """A row per check with the measure nearest to its limit; every measure of one that failed."""
    from mjforage.physics.validation.finding import FAILED, shown

    table = Table("", "check", "measured", "", "limit", "result", box=None, pad_edge=False)
    for finding in findings:
        failed = [measure for measure in finding.measures if not measure.passed]
        rows = failed or [measure for measure in (finding.worst,) if measure]
        for measure in rows:
            value = f"{shown(measure.value)} {measure.unit}".strip()
            style = "red" if finding.status == FAILED else None
            words = (finding.number, finding.name, measure.what, value, measure.limit)
            table.add_row(*words, finding.status, style=style)
        if not rows:
            table.add_row(finding.number, finding.name, "-", "-", "-", finding.status)
    return table
