"""The page of a study: its sections, settings and computing time."""

from collections.abc import Sequence
from typing import Any

from mjforage.view.page.figure import house_style
from mjforage.view.page.table import Row, Table
from mjforage.view.report.clearing import TITLE, clearing_table
from mjforage.view.report.differences import too_few
from mjforage.view.report.map_figures import scenario_figure
from mjforage.view.report.report_page import counted, horizon_words, map_words, scenario_text
from mjforage.view.report.run_logs import pick_replay
from mjforage.view.report.sections import Page, Section
from mjforage.view.report.studies.cost import cost_table, throughput_table
from mjforage.view.report.studies.study_logs import StudyLogs, ordered_policies


def _option(key: str, value: Any) -> str:
    """One option of a study in words."""
    if key == "whole_team":
        return "one draw for the whole team" if value else "a draw per agent"
    return f"{key.replace('_', ' ')} {value}"


def _distinct(words: Sequence[str], noun: str, one: str = "") -> tuple[str, str]:
    """A term and the different ones among some words; `one` stands for a single one."""
    found = list(dict.fromkeys(words))
    return (noun, one or found[0]) if len(found) == 1 else (f"{noun}s", ", ".join(found))


def study_facts(logs: StudyLogs) -> list[tuple[str, str]]:
    """Facts about a study, as pairs of a term and its value."""
    run, info, runs = logs.base, logs.info, [one.run for one in logs.runs.values()]
    pairs = [
        _distinct([one.name for one in runs], "Scenario"),
        _distinct([one.map.name for one in runs], "Map", map_words(run)),
        ("Horizon", " or ".join(dict.fromkeys(map(horizon_words, runs)))),
        ("Worlds", ", ".join(logs.worlds)),
        ("Policies", ", ".join(ordered_policies(logs))),
        ("Variants", str(len(logs.runs))),
        ("Episodes", f"{info.episodes} for each variant, policy and world, seed {info.seed}"),
        ("Options", ", ".join(_option(key, value) for key, value in logs.options.items())),
        ("Started", info.started),
        ("Commit", info.commit),
        ("Versions", ", ".join(f"{name} {number}" for name, number in run.versions.items())),
    ]
    return [(term, value) for term, value in pairs if value]


def opening_sections(logs: StudyLogs) -> list[Section]:
    """Sections on the study's settings, the unchanged scenario, and the clearing of its map."""
    run = Section(
        "run", "What was run", facts=study_facts(logs), texts={"Command": logs.info.command}
    )
    replay = pick_replay(logs.whole)
    with house_style():
        drawn = [scenario_figure(logs.whole, replay)] if replay else []
    table, words = clearing_table(logs.whole), f"Of the variant “{logs.title(logs.first)}”."
    if table is None:
        words += " Every policy cleared the map every time."
    clearing = Section("clearing", TITLE, words, [table] if table else [])
    return [run, Section("scene", "Scenario", pictures=drawn), clearing]


def cost_section(logs: StudyLogs) -> Section:
    """Section on the study's computing time; empty where it was not recorded."""
    name, title = "cost", "Cost and throughput"
    tables = [cost_table(logs), throughput_table(logs)] if any(logs.costs.values()) else []
    return Section(name, title, tables=tables)


def settings_section(logs: StudyLogs) -> Section:
    """Folders of the variants, and the scenario that they vary."""
    rows = tuple(
        Row(f"variants/{name}", (logs.title(name), ", ".join(one.run.policies)))
        for name, one in logs.runs.items()
    )
    title = "Variants, each a run folder"
    folders = Table("variants", title, ("title", "policies"), rows, head="folder", wordy=True)
    tree = scenario_text(logs.info.scenario)
    details = {"Scenario of the first variant, which the others vary (JSON)": tree}
    return Section("settings", "Settings in full", folded=[folders], details=details)


def study_page(logs: StudyLogs, sections: Sequence[Section]) -> Page:
    """The page of these sections."""
    runs = [one.run for one in logs.runs.values()]
    names = list(dict.fromkeys(run.name for run in runs))
    heading = f"{names[0]}: {logs.kind}" if len(names) == 1 else logs.kind.capitalize()
    worlds = f"world{'s' if len(logs.worlds) > 1 else ''} {', '.join(logs.worlds)}"
    maps = " ".join(_distinct([run.map.name for run in runs], "map"))
    played = f"{counted(len(runs), 'variant')}, {counted(logs.info.episodes, 'episode')} each"
    few = too_few(logs.info.episodes)
    lead = " ".join(filter(None, (f"{played}, {worlds}, {maps}.", few)))
    shown = [one for one in sections if not one.empty]
    return Page(heading, lead, shown, logs.base.versions.get("mjforage", ""), "study")
