"""Commands about single vessels."""

import itertools
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter, validators
from rich.table import Table

from mjforage.cli.console import OUT, app, output, print_file, print_list, print_table

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
    out: Annotated[Path | None, OUT] = None,
    plot: Path | None = None,
) -> None:
    """Run one vessel on open water in MuJoCo, from rest: a schedule of commands or a standard test.

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
        Heading at the start [degrees counter-clockwise from east].
    duration
        Duration [s]; default the test's own, or 60 s beyond the schedule.
    dt
        Step of the integration [s], at most 0.05, RK4 in parts no longer than the thrusters' lag.
    out
        CSV to write: t_s,x_m,y_m,yaw_rad,surge_mps,sway_mps,yaw_rate_radps.
    plot
        Figure to write.
    """
    from mjforage.base.atomic_files import atomic_write
    from mjforage.physics.manoeuvre import check_file, key_figures, write_trajectory
    from mjforage.physics.manoeuvre import manoeuvre as run
    from mjforage.view.figures.manoeuvre_plot import check_plot, manoeuvre_figure

    if out is not None:
        check_file(out, "--out")
    if plot is not None:
        check_plot(plot)
    path = run(vessel, schedule, test, current, wind, heading, duration, dt)
    if out is not None:
        write_trajectory(path, out)
    if plot is not None:
        with atomic_write(plot) as beside:
            manoeuvre_figure(path).savefig(beside, format=plot.suffix[1:])
    table = Table("figure", "value", "unit", "meaning")
    for name, figure in key_figures(path).items():
        table.add_row(name, f"{figure.value:.4g}", figure.unit, figure.meaning)
    print_table(table)


@app.command
def calibrate(
    vessel: str,
    /,
    *,
    trials: Annotated[int, Parameter(validator=validators.Number(gte=1, lte=10_000))] = 200,
    seed: Annotated[int, Parameter(validator=validators.Number(gte=0))] = 0,
    output_file: Annotated[Path | None, OUT] = None,
) -> None:
    """Measure a vessel's capture probability, for the rule `rules.capture = "calibrated"`.

    Parameters
    ----------
    vessel
        A vessel (see `mjforage vessels`) or path of a TOML file.
    trials
        Items in every cell: quays beside it, bearing off the bow, distance.
    seed
        Seed of places, headings and noise.
    output_file
        TOML file to write; by default NAME.capture.toml beside the vessel's own, where it is used.
    """
    from mjforage.base.atomic_files import write_bytes
    from mjforage.physics.calibration import calibrate as measured
    from mjforage.scenario.capture import capture_text
    from mjforage.scenario.vessel_files import capture_path

    path = capture_path(vessel) if output_file is None else output_file
    capture = measured(vessel, trials, seed)
    command = f"mjforage calibrate {vessel} --trials {trials} --seed {seed}"
    head = [
        "#:schema ../schemas/capture.json",
        f"# How surely it picks up, counted by `{command}`.",
    ]
    write_bytes(path, capture_text(capture, head).encode())
    table = Table("quays", "m from", "degrees from", "taken by the end of decision 1, 2, 3")
    for cell in capture.cells:
        shares = itertools.accumulate(count / cell.trials for count in cell.taken)
        words = ", ".join(f"{share:.2f}" for share in shares)
        table.add_row(cell.quays, f"{cell.from_m:g}", f"{cell.from_deg:g}", words)
    print_table(table)


@app.command(name="estimate-vessel")
def estimate_vessel(
    *,
    length: float,
    beam: float,
    mass: float,
    thrust: float,
    top_speed: float,
    output_file: Annotated[Path, OUT],
) -> None:
    """Write the file of a vessel from a few numbers, every other number marked as an estimate.

    Parameters
    ----------
    length
        Length [m].
    beam
        Width [m].
    mass
        Mass with payload [kg].
    thrust
        Thrust ahead of both thrusters together, moored [N].
    top_speed
        Speed with that command [m/s].
    output_file
        TOML file to write.
    """
    from mjforage.base.atomic_files import write_bytes
    from mjforage.physics.vessel_estimates import estimate_vessel as estimated

    text = estimated(length, beam, mass, thrust, top_speed)
    write_bytes(output_file, text.encode())
    output.print(f"vessel: {output_file}", soft_wrap=True)


@app.command
def vessels(vessel: str | None = None, /) -> None:
    """List the vessels that ship with the package, or print the file of one.

    Parameters
    ----------
    vessel
        Name of a shipped vessel, so that `mjforage vessels scout > my_boat.toml` copies its file,
        or path of yours; without a `[control]` table it is printed with the one that is used then.
    """
    from mjforage.physics.vessel_models import control_table
    from mjforage.physics.vessels import load_vessel
    from mjforage.scenario.vessel_files import vessel_names, vessel_path

    if vessel is not None:
        loaded = load_vessel(vessel)
        more = () if loaded.control else ("\n", control_table(loaded))
        print_file(vessel_path(vessel), *more)
        return
    hulls = [load_vessel(name) for name in vessel_names()]
    print_list((v.name, f"{v.length_m:g} x {v.beam_m:g} m, {v.mass_kg:g} kg") for v in hulls)
