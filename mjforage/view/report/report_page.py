"""`report.html` of a run: its tables, its figures, and the page of them."""

import json
from collections import Counter
from collections.abc import Sequence

from mjforage.runs.run_info import RunInfo
from mjforage.view.page import Table, style
from mjforage.view.page.figure import ReportFigure, house_style
from mjforage.view.report.cells import minutes, number
from mjforage.view.report.clearing import clearing_table
from mjforage.view.report.curves import time_figures
from mjforage.view.report.differences import too_few
from mjforage.view.report.distributions import distribution_figures
from mjforage.view.report.hull_tables import hulls_table
from mjforage.view.report.map_figures import scenario_figure
from mjforage.view.report.policy_pairs import comparison_table
from mjforage.view.report.reality_gap import gap_figures, gap_tables
from mjforage.view.report.run_logs import RunLogs, pick_replay
from mjforage.view.report.sections import Page, Section
from mjforage.view.report.shown import left_out
from mjforage.view.report.text_tables import full_table, headline_table, paper_table
from mjforage.view.report.track_figure import tracks_figure
from mjforage.view.report.words import WORDS

CASES = 300  # worlds and policies of the headline table on the page


def map_words(run: RunInfo) -> str:
    """Name and size of a run's map."""
    rows, columns = run.map.cells.shape
    pitch = f"{run.map.pitch_m:g} m"
    return f"{run.map.name}: {rows} × {columns}, {run.map.nodes} nodes {pitch} apart"


def horizon_words(run: RunInfo) -> str:
    """Horizon of a run, in steps and minutes."""
    length_min = number(minutes(run, run.horizon), 0)
    return f"T = {run.horizon} steps of {run.period_s:g} s: {length_min} min"


def versions_words(run: RunInfo) -> str:
    """Versions that a run was made with."""
    return ", ".join(f"{name} {version}" for name, version in run.versions.items())


def curve_words(run: RunInfo) -> str:
    """Explanation of figures over time."""
    return (
        "Lines: mean of the episodes where the metric is defined; bands: ± 1.96 SEM. Time is "
        f"normalised by the horizon, {horizon_words(run)}."
    )


def run_facts(logs: RunLogs) -> list[tuple[str, str]]:
    """Facts about a run, as pairs of a term and its value."""
    run = logs.run
    fleet = Counter(agent.team for agent in run.agents)
    each = "policy" if len(run.worlds) == 1 else "policy and world"
    timings = ", ".join(
        f"{key[:-2]} {value:.1f} s" if key.endswith("_s") else f"{key} {value:g}"
        for key, value in run.timings.items()
    )
    return [
        ("Scenario", run.name),
        ("Map", map_words(run)),
        ("Fleet", ", ".join(f"{count} {team}" for team, count in fleet.items()) or "no vessels"),
        ("Horizon", horizon_words(run)),
        ("Worlds", ", ".join(run.worlds)),
        ("Policies", ", ".join(logs.policies)),
        ("Episodes", f"{run.episodes} for each {each}, seed {run.seed}"),
        ("Started", run.started),
        ("Time spent", timings or "not logged"),
        ("Versions", versions_words(run)),
        ("Hash", run.hash),
    ]


NOTES = tuple(WORDS["notes"])
"""Notes on numbers of ours that follow another definition than the paper's printed ones."""


def notes_section(notes: Sequence[str] = NOTES) -> Section:
    """Section of notes, by default those above."""
    return Section("notes", "Notes on definitions", items=notes)


def metric_tables(logs: RunLogs) -> list[Table]:
    """Tables of metrics of all policies of a run."""
    return [headline_table(logs), paper_table(logs), full_table(logs)]


def draw_figures(logs: RunLogs) -> list[ReportFigure]:
    """Draw every figure: scenario, tracks, reality gap, curves, distributions.

    The scenario is drawn from a replay: a run that keeps none goes without.
    """
    replay = pick_replay(logs)
    with house_style():
        return [
            *([scenario_figure(logs, replay)] if replay else []),
            tracks_figure(logs),
            *gap_figures(logs),
            *time_figures(logs),
            *distribution_figures(logs),
        ]


def counted(number: int, noun: str) -> str:
    """A number of things, each of which is one such noun."""
    plural = f"{noun[:-1]}ies" if noun.endswith("y") else f"{noun}s"
    return f"{number} {noun if number == 1 else plural}"


def scenario_text(tree: object) -> str:
    """Settings in full."""
    return json.dumps(tree, indent=2, ensure_ascii=False)


def report_page(logs: RunLogs, shown: RunLogs, pictures: Sequence[ReportFigure]) -> Page:
    """The page of a run.

    `logs`, `shown`: the run, and what of it the page shows; `pictures`: of what is shown.
    """
    run = logs.run
    headline = headline_table(shown if len(logs.cases) > CASES else logs)
    notes = " ".join(filter(None, (left_out(logs, shown), too_few(run.episodes))))
    gap = [one for one in pictures if one.name == "gap"]
    others = [one for one in pictures if one not in gap]
    wide, narrow = ([one for one in others if one.wide is w] for w in (True, False))
    sections = [
        Section("result", "Result in brief", notes, [headline, clearing_table(shown)]),
        Section("run", "What was run", facts=run_facts(logs), texts={"Command": run.command}),
        Section("scene", "Scenario and tracks", pictures=wide),
        Section("figures", "Figures", curve_words(run), pictures=narrow),
        Section("gap", "The reality gap", pictures=gap, folded=gap_tables(shown)),
        Section("hulls", "Performance of the hulls", folded=[hulls_table(shown)]),
        Section("tables", "The paper's tables", tables=[paper_table(shown)]),
        Section("all", "All metrics", folded=[full_table(shown)]),
        Section("comparison", "Paired comparison", folded=[comparison_table(shown)]),
        notes_section(),
        Section(
            "settings",
            "Settings in full",
            details={"Scenario as it was run (JSON)": scenario_text(run.scenario)},
        ),
    ]
    played = f"{counted(len(run.policies), 'policy')}, {counted(run.episodes, 'episode')} each"
    lead = f"{played}; worlds: {', '.join(run.worlds)}; map {run.map.name}"
    chips = {name: look.colour for name, look in style.policy_styles(shown.policies).items()}
    version = run.versions.get("mjforage", "")
    return Page(run.name, lead, sections, version, chips=chips)
