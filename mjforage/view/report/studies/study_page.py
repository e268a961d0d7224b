"""The page of a study: its sections, settings and computing time."""

from collections.abc import Iterable, Sequence

from mjforage.view.page.figure import house_style
from mjforage.view.page.table import Row, Table
from mjforage.view.report.differences import too_few
from mjforage.view.report.map_figures import scenario_figure
from mjforage.view.report.report_page import (
    counted,
    horizon_words,
    map_words,
    scenario_text,
    versions_words,
)
from mjforage.view.report.run_logs import pick_replay
from mjforage.view.report.sections import Page, Section
from mjforage.view.report.studies.study_logs import StudyLogs, ordered_policies


def _distinct(words: Iterable[str]) -> str:
    """The different ones among some words."""
    return ", ".join(dict.fromkeys(words))


def study_facts(logs: StudyLogs) -> list[tuple[str, str]]:
    """Facts about a study, as pairs of a term and its value."""
    run, info, runs = logs.base, logs.info, [one.run for one in logs.runs.values()]
    options = (f"{key.replace('_', ' ')} {value}" for key, value in info.options.items())
    pairs = [
        ("Scenario", _distinct(one.name for one in runs)),
        ("Map", _distinct(map(map_words, runs))),
        ("Horizon", _distinct(map(horizon_words, runs))),
        ("Worlds", ", ".join(logs.worlds)),
        ("Policies", ", ".join(ordered_policies(logs))),
        ("Variants", str(len(logs.runs))),
        ("Episodes", f"{info.episodes} for each variant, policy and world, seed {info.seed}"),
        ("Options", ", ".join(options)),
        ("Started", info.started),
        ("Commit", info.commit),
        ("Versions", versions_words(run)),
    ]
    return [(term, value) for term, value in pairs if value]


def opening_sections(logs: StudyLogs) -> list[Section]:
    """Sections on the study's settings and the unchanged scenario."""
    facts, replay = study_facts(logs), pick_replay(logs.whole)
    with house_style():
        drawn = [scenario_figure(logs.whole, replay)] if replay else []
    return [
        Section("run", "What was run", facts=facts, texts={"Command": logs.info.command}),
        Section("scene", "Scenario", pictures=drawn),
    ]


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
    runs, kind = [one.run for one in logs.runs.values()], logs.info.kind
    alike = len({run.name for run in runs}) == 1
    played = f"{counted(len(runs), 'variant')}, {counted(logs.info.episodes, 'episode')} each"
    where = f"worlds: {', '.join(logs.worlds)}; maps: {_distinct(run.map.name for run in runs)}"
    lead = " ".join(filter(None, (f"{played}; {where}.", too_few(logs.info.episodes))))
    heading = f"{runs[0].name}: {kind}" if alike else kind.capitalize()
    return Page(heading, lead, sections, logs.base.versions.get("mjforage", ""), "study")
