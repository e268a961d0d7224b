"""`mjforage bench`."""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich.table import Table

from mjforage.base.errors import UserError
from mjforage.cli.console import OUT, app, errors, print_table

if TYPE_CHECKING:
    from mjforage.bench.running import Figures


def _rounded(value: float) -> str:
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


@app.command
def bench(
    *,
    out: Annotated[Path | None, Parameter(name=OUT.name, alias=("--output", "--json"))] = None,
    against: Path | None = None,
    slices: int = 9,
    decisions: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Measure speeds on this machine, in CPU seconds of one core.

    Parameters
    ----------
    out
        Also write the figures to this file: {key: {"value", "unit"}}, and the
        "quickest" slice of a speed, whose value is the median; or a list of comparisons.
    against
        Folder of another checkout: measure it beside this one, in slices of CPU time in turn, which
        is the way to compare two states of the code on a machine with other work to do.
    slices
        Slices of each side and workload, with --against.
    decisions
        Only what every policy takes to decide once for a fleet of 4, 16 and 64 agents.
    """
    from mjforage.base.atomic_files import write_json

    if out is not None and not out.parent.is_dir():
        raise UserError(f"--out {out}: cannot be written, no folder {out.parent}")
    if decisions and against is not None:
        raise UserError(f"--decisions, --against {against}: give one of them")
    found: object
    if decisions:
        found = _decided()
    else:
        found = _measured() if against is None else _compared(against, slices)
    if out is not None:
        write_json(out, found)


def _measured() -> "Figures":
    from mjforage.bench.running import bench as measure

    with errors.status("measuring") as status:
        figures = measure(lambda key: status.update(f"measuring {key}"))
    table = Table("figure", "value", "quickest", "unit")
    for key, figure in figures.items():
        quickest = _rounded(float(figure["quickest"])) if "quickest" in figure else ""
        table.add_row(key, _rounded(float(figure["value"])), quickest, str(figure["unit"]))
    print_table(table)
    return figures


def _decided() -> list[dict[str, float | str]]:
    from mjforage.bench.decisions import FLEETS, decision_times

    with errors.status("measuring") as status:
        times = decision_times(progress=lambda name: status.update(f"measuring {name}"))
    table = Table("policy", *(f"{agents} agents [ms]" for agents in FLEETS))
    rows: dict[str, list[str]] = {}
    for one in times:
        words = one.reason or f"{one.ms:.3g} ({one.low:.3g} to {one.high:.3g})"
        rows.setdefault(one.policy, []).append(words)
    for policy, cells in rows.items():
        table.add_row(policy, *cells)
    print_table(table)
    return [asdict(one) for one in times]


def _compared(other: Path, slices: int) -> list[dict[str, float | str]]:
    from mjforage.bench.against import against

    with errors.status("measuring") as status:
        pairs = against(other, slices, progress=lambda name: status.update(f"measuring {name}"))
    table = Table("work per CPU second", "this code", str(other), "ratio", "middle half of ratios")
    for pair in pairs:
        half = f"{pair.low:.2f} to {pair.high:.2f}"
        rates = _rounded(pair.ours), _rounded(pair.theirs)
        table.add_row(pair.name, *rates, f"{pair.ratio:.2f}", half)
    print_table(table)
    return [asdict(pair) for pair in pairs]
