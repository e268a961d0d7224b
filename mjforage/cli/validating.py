"""`mjforage validate`."""

import sys

from rich.table import Table

from mjforage.cli.console import app, output, print_table

FAILED_CODE = 1


@app.command
def validate(vessel: str, /) -> None:
    """Check the motion of a vessel in MuJoCo; exit code 1 if a check fails.

    Parameters
    ----------
    vessel
        A vessel (see `mjforage vessels`) or path of a TOML file.
    """
    from mjforage.physics.mission_trial import mission_measures
    from mjforage.physics.run_warnings import vessel_warnings
    from mjforage.physics.vessel_checks import formatted, measures_of
    from mjforage.physics.vessels import load_vessel

    loaded = load_vessel(vessel)
    measures = [*measures_of(loaded), *mission_measures(vessel)]
    table = Table("check", "measured", "limit", "result", box=None, pad_edge=False)
    for measure in measures:
        value = f"{formatted(measure.value)} {measure.unit}".strip()
        result, style = ("passed", None) if measure.passed else ("failed", "red")
        table.add_row(measure.what, value, measure.limit, result, style=style)
    print_table(table)
    for line in vessel_warnings(loaded, 0.0, 0.1):
        output.print(f"note: {line}", soft_wrap=True)
    if not all(measure.passed for measure in measures):
        sys.exit(FAILED_CODE)
