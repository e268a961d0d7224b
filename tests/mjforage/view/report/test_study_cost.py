"""Cost section of a study's page, on records written by hand."""

from pathlib import Path

from mjforage.runs.costs import Cost
from mjforage.runs.studies.study import StudyInfo
from mjforage.view.page.table import Table
from mjforage.view.report.studies.cost import cost_table
from mjforage.view.report.studies.study_logs import StudyLogs

CALLS = {"monday": 1, "tuesday": 4}


def chunk(
    policy: str, began_s: float, wall_s: float, *, call: str = "monday", worker: str = "a-1"
) -> Cost:
    """A chunk of 10 episodes of 100 decisions; the worker is busy for 0.8 of the time."""
    cpu_s = 0.8 * wall_s
    return Cost(
        *("graph", policy, 10, 1000, cpu_s, wall_s, began_s, worker, call, "processes"),
        CALLS[call],
    )


def study(*variants: tuple[Cost, ...], kind: str = "paper") -> StudyLogs:
    costs = {str(place): costs for place, costs in enumerate(variants)}
    info = StudyInfo("", "", kind, {}, {}, ("graph",), 1, 0, {})
    return StudyLogs(Path(), info, {}, costs)


def cells(table: Table, head: str) -> dict[str, str]:
    """Label and unit -> text, of the row of that name."""
    (row,) = [row for row in table.rows if head in (row.head, f"{row.group}: {row.head}")]
    labels = [
        f"{label} {unit}".strip() for label, unit in zip(table.columns, table.units, strict=True)
    ]
    return dict(zip(labels, row.cells, strict=True))


def test_cpu_time_per_episode_is_of_each_policy_without_first_chunks() -> None:
    # Greedy: 10 episodes took 8, 8 and 16 CPU s in two variants after a first chunk that compiled:
    # 0.8 and 1.6 s per episode, mean 1.2, SEM sqrt(0.32 / 2) = 0.4, so 1.2 +- 0.784 s. Levy has one
    # chunk: no interval.
    logs = study(
        (
            chunk("greedy", 0.0, 500.0),
            chunk("greedy", 500.0, 10.0),
            chunk("levy", 510.0, 50.0),
            chunk("greedy", 600.0, 10.0),
        ),
        (chunk("greedy", 560.0, 20.0),),
    )
    table = cost_table(logs)
    greedy, levy = cells(table, "greedy"), cells(table, "levy")
    assert greedy["CPU time s per episode"] == "1.20 ± 0.78"
    assert (greedy["variants"], greedy["episodes"]) == ("2", "30")
    assert greedy["CPU time ms per decision"] == "10.7", "32 CPU s for 3,000 of them"
    assert greedy["episodes per chunk"] == "10.0"
    assert levy["CPU time s per episode"] == "4.00"
