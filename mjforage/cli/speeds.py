"""`mjforage bench`."""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter
from rich.table import Table

from mjforage.base.errors import UserError
from mjforage.base.extras import require
from mjforage.cli.console import OUT, app, errors, print_table

if TYPE_CHECKING:
    from mjforage.bench.running import Progress, Rate


def _rounded(value: float) -> str:
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


def _on_device(device: str, progress: "Progress") -> "dict[str, Rate]":
    from mjforage.base.device import require_gpu

    require("bench --device", "mujoco_warp", "torch")
    if device == "cuda":
        require_gpu("bench --device cuda")
    from mjforage.bench.on_device import speeds

    return dict(speeds(device, progress))


@app.command
def bench(
    *,
    out: Annotated[Path | None, Parameter(name=OUT.name, alias=("--output", "--json"))] = None,
    decisions: Annotated[bool, Parameter(negative="")] = False,
    device: Literal["cuda", "warp-cpu"] | None = None,
) -> None:
    """Measure speeds on this machine, in CPU seconds of one core.

    Parameters
    ----------
    out
        Also write the figures to this file: {key: {"value", "quickest", "unit"}}, the median of
        slices and the fastest; or a list of decision times.
    decisions
        Only the time of one decision of every policy, for a fleet of 4, 16 and 64 agents.
    device
        Only fleets and environments on a device, per second of time: a GPU, or this processor.
    """
    if decisions and device is not None:
        raise UserError(f"--device {device}: has no --decisions; leave out one of them")
    if not decisions and device is None:
        require("bench", "torch")  # before minutes of measuring
    from mjforage.base.atomic_files import write_json
    from mjforage.bench import decisions as deciding
    from mjforage.bench import running

    if out is not None and not out.parent.is_dir():
        raise UserError(f"--out {out}: cannot be written, no folder {out.parent}")
    found: object
    with errors.status("measuring") as status:

        def progress(name: str) -> None:
            status.update(f"measuring {name}")

        if decisions:
            times = deciding.decision_times(progress=progress)
            table = Table("policy", "agents", "ms", "range", "")
            for one in times:
                span = "" if one.reason else f"{one.low:.3g} to {one.high:.3g}"
                table.add_row(one.policy, str(one.agents), f"{one.ms:.3g}", span, one.reason)
            found = [asdict(one) for one in times]
        else:
            figures = _on_device(device, progress) if device else running.bench(progress)
            table = Table("figure", "value", "quickest", "unit")
            for key, speed in figures.items():
                table.add_row(key, _rounded(speed.value), _rounded(speed.quickest), speed.unit)
            found = {key: asdict(speed) for key, speed in figures.items()}
    print_table(table)
    if out is not None:
        write_json(out, found)
