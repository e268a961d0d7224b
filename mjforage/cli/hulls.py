"""Commands about single hulls."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.table import Table

from mjforage.cli.console import app, output, print_list

Flow = Parameter(allow_leading_hyphen=True)  # so that a speed below 0 gets an error of its own


@app.command
def manoeuvre(
    vessel: str,
    /,
    *,
    schedule: Path | None = None,
    test: str | None = None,
    current: Annotated[str, Flow] = "0@0",
    wind: Annotated[str, Flow] = "0@0",
    heading: float = 0.0,
    duration: float | None = None,
    dt: float = 0.05,
    out: Path | None = None,
    plot: Path | None = None,
) -> None:
    """Run one hull on open water in MuJoCo, from rest: a schedule of commands or a standard test.

    Parameters
    ----------
    vessel
        A vessel (see `mjforage vessels`) or path of a TOML file.
    schedule
        CSV with columns t_s,left,right: propeller rad/s or newtons, each row until the next.
    test
        turning-circle, turning-circle-starboard, zigzag, zigzag-20, straight, stop or drift.
    current
        SPEED@DIRECTION it flows to [m/s, 0 or more; degrees counter-clockwise from east].
    wind
        The same for the wind.
    heading
        At the start [degrees counter-clockwise from east].
    duration
        How long [s]; default the test's own, or 60 s beyond the schedule.
    dt
        Step of the integration [s], RK4 in parts of at most 0.05 s and the thrusters' lag.
    out
        CSV to write: t_s,x_m,y_m,yaw_rad,surge_mps,sway_mps,yaw_rate_radps.
    plot
        Picture to write.
    """
    from mjforage.core.whole_files import whole
    from mjforage.physics.manoeuvre import (
        check_file,
        key_figures,
        write_trajectory,
    )
    from mjforage.physics.manoeuvre import manoeuvre as run
    from mjforage.physics.simulation.mujoco_hull import MujocoHull
    from mjforage.view.manoeuvre_plot import check_plot, manoeuvre_figure

    if out is not None:
        check_file(out, "--out")
    if plot is not None:
        check_plot(plot)
    path = run(vessel, schedule, test, current, wind, heading, duration, dt, MujocoHull)
    if out is not None:
        write_trajectory(path, out)
    if plot is not None:
        with whole(plot) as beside:
            manoeuvre_figure(path).savefig(beside, format=plot.suffix[1:])
    table = Table("figure", "value", "unit", "meaning")
    for name, figure in key_figures(path).items():
        table.add_row(name, f"{figure.value:.4g}", figure.unit, figure.meaning)
    output.print(table)


@app.command
def vessels() -> None:
    """List the vessels that ship with the package."""
    from mjforage.physics.vessels import load_vessel, vessel_names

    hulls = [load_vessel(name) for name in vessel_names()]
    print_list((v.name, f"{v.length_m:g} x {v.beam_m:g} m, {v.mass_kg:g} kg") for v in hulls)
