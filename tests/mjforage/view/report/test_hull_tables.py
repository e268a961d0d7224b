"""Performance of vessels, on decisions written by hand."""

from collections.abc import Callable
from pathlib import Path

import polars as pl

from mjforage.view.report.hull_tables import hulls_table
from mjforage.view.report.run_logs import load_logs

STAY = 8
DECISIONS = {  # episode -> direction, outcome, speed [m/s], touches so far, fastest [m/s], work [J]
    0: (
        (0, "arrived", 0.5, 0, 0.0, 1000.0),
        (1, "late", 0.25, 1, 0.25, 2000.0),
        (STAY, "arrived", 0.0, 1, 0.25, 2500.0),
        (STAY, "late", 0.0, 2, 0.25, 3000.0),
    ),
    1: (
        (0, "blocked", 0.0, 0, 0.0, 1000.0),
        (STAY, "blocked", 0.0, 0, 0.0, 2000.0),
        (2, "arrived", 0.75, 1, 0.125, 4000.0),
        (STAY, "arrived", 0.0, 1, 0.125, 5000.0),
    ),
}


def test_outcomes_speeds_touches_and_energy_by_hand(make_run: Callable[..., Path]) -> None:
    """Five moves: who has no legal one is blocked, not staying. Three stays, of which two kept.

    Speed is of the three decisions with any way. 3 touches and 8 kJ in two episodes, 4 items.
    """
    folder = make_run(
        worlds=("physics",), policies=("greedy",), episodes=2, horizon=4, scouts=1, foragers=1
    )
    names = ("direction", "outcome", "speed_mps", "collisions", "impact_mps", "work_j")
    start = (None, "start", 0.0, 0, 0.0, 0.0)
    rows = [
        {"world": "physics", "policy": "greedy", "episode": e, "step": step, "agent": agent}
        | {"x_m": 0.0, "y_m": 0.0}
        | dict(zip(names, row, strict=True))
        for e, decisions in DECISIONS.items()
        for agent, own in ((0, [decisions[0]] * 4), (1, decisions))
        for step, row in enumerate((start, *own))
    ]
    pl.DataFrame(rows, infer_schema_length=None).write_parquet(folder / "agents.parquet")
    items = pl.read_parquet(folder / "items.parquet")
    taken = pl.when(pl.col("item") < 2).then(3).otherwise(None).cast(pl.Int64)
    items.with_columns(t_collected=taken).write_parquet(folder / "items.parquet")
    table = hulls_table(load_logs(folder))
    heads = list(zip(table.columns, table.units, strict=True))
    found = {row.head: dict(zip(heads, row.cells, strict=True)) for row in table.rows}
    assert found["foragers"] == {
        ("moves", ""): "5",
        ("arrived", "%"): "40.00",
        ("late", "%"): "20.00",
        ("blocked", "%"): "40.00",
        ("stays", ""): "3",
        ("kept", "%"): "66.67",
        ("speed", "m/s"): "0.50",
        ("touches", "per episode"): "1.50",
        ("fastest touch", "m/s"): "0.25",
        ("energy", "kJ per episode"): "4.0",
        ("energy", "kJ per item"): "2.00",
    }
    assert found["scouts"]["moves", ""] == "8"
