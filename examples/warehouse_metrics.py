"""The cooperation metrics on another domain: a warehouse where locators find and carriers fetch.

Pallets stand in unknown bays of a warehouse. Two locators each read one whole aisle per step and
note what stands there; three carriers fetch noted pallets, oldest note first, and scan every bay
of the aisle they drive into, so that now and then a carrier finds a pallet itself. Compared are
two ways of locating: `sweep` goes through the aisles in turn, `roam` picks them at random.

Only `metrics` is used, on an event table and plain arrays: python examples/warehouse_metrics.py
"""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from mjforage import metrics

AISLES, BAYS = 24, 12
PALLETS = 40
LOCATORS = 2  # agents 0 and 1
CARRIERS = 3  # agents 2, 3, 4
LEGIBLE = 0.2  # chance that a locator can read the label of a pallet it passes
HORIZON = 90  # [step]
RUNS = 200
SEED = 7

Array = NDArray[np.float64]


@dataclass
class Log:
    """Record of one run; index 0 of the series is the state before the first step."""

    found_at: Array = field(default_factory=lambda: np.full(PALLETS, np.nan))
    found_by: NDArray[np.int64] = field(default_factory=lambda: np.full(PALLETS, -1))
    fetched_at: Array = field(default_factory=lambda: np.full(PALLETS, np.nan))
    fetched_by: NDArray[np.int64] = field(default_factory=lambda: np.full(PALLETS, -1))
    idleness: list[Array] = field(default_factory=lambda: [np.ones(AISLES)])
    overlap: list[float] = field(default_factory=list)
    error: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class Rules:
    """Rules of a warehouse: `roaming` is the chance that a locator picks a random aisle."""

    roaming: float
    locators: int = LOCATORS
    carriers: int = CARRIERS


def simulate(rules: Rules, run: int) -> Log:
    """Run one day; the pallets of run i are the same under all rules."""
    bays = np.random.default_rng([SEED, run, 0]).choice(AISLES * BAYS, PALLETS, replace=False)
    draws = np.random.default_rng([SEED, run, 1])
    aisle_of = bays // BAYS
    log = Log()
    free_at = np.zeros(rules.carriers)
    for step in range(1, HORIZON + 1):
        read = locate(rules, step, draws)
        readable = draws.random(PALLETS) < LEGIBLE
        note(log, readable & np.isin(aisle_of, read), aisle_of, read, step)
        for carrier in np.flatnonzero(free_at <= step):
            free_at[carrier] = fetch(log, aisle_of, LOCATORS + int(carrier), step, draws)
        watch(log, read, bays)
    return log


def locate(rules: Rules, step: int, draws: np.random.Generator) -> NDArray[np.int64]:
    """Aisle that each locator reads now, (locator,)."""
    share = AISLES // LOCATORS
    in_turn = np.arange(rules.locators) * share + step % share
    roams = draws.random(LOCATORS)[: rules.locators] < rules.roaming
    return np.where(roams, draws.integers(AISLES, size=LOCATORS)[: rules.locators], in_turn)


def note(
    log: Log,
    in_view: NDArray[np.bool_],
    aisle_of: NDArray[np.int64],
    read: NDArray[np.int64],
    step: int,
) -> None:
    """Credit new finds to the first locator in the pallet's aisle."""
    for pallet in np.flatnonzero(in_view & np.isnan(log.found_at)):
        log.found_at[pallet] = step
        log.found_by[pallet] = int(np.flatnonzero(read == aisle_of[pallet])[0])


def fetch(
    log: Log, aisle_of: NDArray[np.int64], agent: int, step: int, draws: np.random.Generator
) -> float:
    """Send a carrier for the oldest note; give the step from which it is free again."""
    waiting = np.flatnonzero(~np.isnan(log.found_at) & np.isnan(log.fetched_at))
    if waiting.size == 0:
        return step + 1
    pallet = waiting[np.argmin(log.found_at[waiting])]
    log.fetched_at[pallet], log.fetched_by[pallet] = step, agent
    beside = np.flatnonzero((aisle_of == aisle_of[pallet]) & np.isnan(log.found_at))
    log.found_at[beside], log.found_by[beside] = step, agent
    return step + 1 + int(draws.integers(4)) + agent  # later carriers park further away


def watch(log: Log, read: NDArray[np.int64], bays: NDArray[np.int64]) -> None:
    """Record what the per-step metrics need."""
    times_seen = np.bincount(read, minlength=AISLES)
    aged = np.minimum(log.idleness[-1] + 1 / HORIZON, 1.0)
    log.idleness.append(np.where(times_seen > 0, 0.0, aged))
    log.overlap.append(float(metrics.coverage_overlap(times_seen)))
    stands = np.isnan(log.fetched_at)
    known = stands & ~np.isnan(log.found_at)
    truth = np.bincount(bays[stands], minlength=AISLES * BAYS)
    noted = np.bincount(bays[known], minlength=AISLES * BAYS)
    log.error.append(float(metrics.model_error(truth, noted, np.ones((AISLES, BAYS), bool))[0]))


def evaluate(rules: Rules, runs: int) -> dict[str, Array]:
    """Every metric of every run, name -> (run,)."""
    logs = [simulate(rules, run) for run in range(runs)]
    events = metrics.EventTable(
        discovered_at=np.stack([log.found_at for log in logs]),
        discovered_by=np.stack([log.found_by for log in logs]),
        collected_at=np.stack([log.fetched_at for log in logs]),
        collected_by=np.stack([log.fetched_by for log in logs]),
        exists=np.ones((runs, PALLETS), dtype=bool),
    )
    locators = np.arange(rules.locators)
    carriers = LOCATORS + np.arange(rules.carriers)
    found = metrics.pta_series(events.discovered_at, events.exists, HORIZON)
    fetched = metrics.pta_series(events.collected_at, events.exists, HORIZON)
    idleness = metrics.mean_idleness(np.stack([np.stack(log.idleness) for log in logs]))
    return {
        "PTA found, %": found[:, -1],
        "PTA fetched, %": fetched[:, -1],
        "RMSE, mean": np.array([np.mean(log.error) for log in logs]),
        "NT 50 %": metrics.nt(fetched, 50.0),
        "NT 90 %": metrics.nt(fetched, 90.0),
        "throughput carriers": metrics.throughput(events.collected_at, rules.carriers, HORIZON),
        "throughput locators": metrics.throughput(events.discovered_at, rules.locators, HORIZON),
        "mean idleness, final": idleness[:, -1],
        "IRR, mean": metrics.irr(idleness).mean(axis=-1),
        "DSL": metrics.mean_dsl(events, locators, HORIZON),
        "ITL": metrics.itl(found, fetched),
        "CSR": metrics.csr_series(events, locators, HORIZON)[..., -1],
        "Gini carriers": metrics.gini(metrics.contributions(events.collected_by, carriers)),
        "Gini locators": metrics.gini(metrics.contributions(events.discovered_by, locators)),
        "overlap locators": metrics.mean([log.overlap for log in logs]),
    }


def comparison(sweep: dict[str, Array], roam: dict[str, Array]) -> Table:
    """Both strategies side by side, with paired difference and probability of improvement."""
    table = Table(title=f"Warehouse, {len(next(iter(sweep.values())))} runs")
    for heading in ("metric", "sweep", "roam", "sweep - roam [95 %]", "P(sweep > roam)"):
        table.add_column(heading, justify="left" if heading == "metric" else "right")
    for name, ours in sweep.items():
        theirs = roam[name]
        gap = metrics.paired_difference(ours, theirs, SEED)
        better = metrics.probability_of_improvement(ours, theirs)
        cells = [
            f"{metrics.mean(side):.3f} ± {metrics.half_width_95(side):.3f}"
            for side in (ours, theirs)
        ]
        interval = f"{gap.value:+.3f} [{gap.low:+.3f}, {gap.high:+.3f}]"
        table.add_row(name, *cells, interval, f"{better:.2f}")
    return table


def teamwork(runs: int) -> Table:
    """Worth of one agent, and sensitivity of fetching to aimless locators."""
    sweep, name = Rules(roaming=0.0), "PTA fetched, %"
    full = metrics.mean(evaluate(sweep, runs)[name])
    table = Table(title=f"Team work under sweep, {runs} runs, measured on {name}")
    table.add_column("metric")
    table.add_column("value", justify="right")
    for label, rules in {
        "locator": replace(sweep, locators=LOCATORS - 1),
        "carrier": replace(sweep, carriers=CARRIERS - 1),
    }.items():
        without = metrics.mean(evaluate(rules, runs)[name])
        worth = metrics.marginal_contribution(full, without, higher_is_better=True)
        table.add_row(f"marginal contribution of a {label}", f"{worth:.3f}")
    levels = np.linspace(0.0, 1.0, 6)
    values = np.stack([evaluate(Rules(roaming=float(level)), runs)[name] for level in levels])
    line = metrics.sensitivity_slope(levels, metrics.mean(values))
    bend = metrics.two_segment_fit(levels, metrics.mean(values))
    slope = f"{line.slope:.2f} [{line.low:.2f}, {line.high:.2f}]"
    table.add_row("sensitivity slope (% per unit of roaming)", slope)
    table.add_row(
        "break point, slope before and after",
        f"{bend.break_point:.2f}: {bend.slope_before:.2f}, {bend.slope_after:.2f}",
    )
    return table


def main(runs: int = RUNS, console: Console | None = None) -> None:
    """Print both tables."""
    out = console or Console()
    out.print(comparison(evaluate(Rules(roaming=0.0), runs), evaluate(Rules(roaming=1.0), runs)))
    out.print(teamwork(max(2, runs // 4)))


if __name__ == "__main__":
    main()
