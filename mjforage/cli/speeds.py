"""`mjforage bench`."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.table import Table

from mjforage.cli.console import app, errors, output
from mjforage.core.errors import UserError


def _rounded(value: float) -> str:
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


@app.command
def bench(*, json_file: Annotated[Path | None, Parameter(name="--json")] = None) -> None:
    """Measure speeds on this machine, in CPU seconds of one core.

    Parameters
    ----------
    json_file
        Also write {key: {"value", "unit"}} to this file.
    """
    from mjforage.bench.running import bench as measure
    from mjforage.core.whole_files import write_json

    if json_file is not None and not json_file.parent.is_dir():
        raise UserError(f"--json {json_file}: cannot be written, no folder {json_file.parent}")

    with errors.status("measuring") as status:
        figures = measure(lambda key: status.update(f"measuring {key}"))
    table = Table("figure", "value", "unit")
    for key, figure in figures.items():
        table.add_row(key, _rounded(float(figure["value"])), str(figure["unit"]))
    output.print(table)
    if json_file is not None:
        write_json(json_file, figures)
