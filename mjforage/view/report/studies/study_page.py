"""The page of a study: sections of tables and figures, what was run, and what it took."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any

from mjforage.view.page import EmbeddedFigure, embedded_within, render_page, style
from mjforage.view.page.figure import ReportFigure, house_style
from mjforage.view.page.table import Table
from mjforage.view.report.clearing import TITLE, clearing_table
from mjforage.view.report.differences import too_few
from mjforage.view.report.map_figures import scenario_figure
from mjforage.view.report.report_page import horizon_words, map_words
from mjforage.view.report.run_logs import pick_replay
from mjforage.view.report.shown import FIGURES, LARGEST, ROWS, cut
from mjforage.view.report.studies.cost import cost_table, throughput_picture, throughput_table
from mjforage.view.report.studies.study_logs import StudyLogs
from mjforage.view.report.web_replay import BUDGET, WebReplay, web_replay

CLEARING = "clearing"  # section of horizons, which has no differences
ALL = "`mjforage report FOLDER --tables csv` writes all"
FEWEST_ROWS = 20  # of a table on the page, however large the others are


@dataclass(frozen=True)
class Section:
    """A part of the page. `words` may carry subscripts and code as tables do."""

    name: str  # anchor
    title: str
    words: str = ""
    tables: Sequence[Table] = ()
    pictures: Sequence[ReportFigure] = ()
    folded: Sequence[Table] = ()  # after the pictures, closed where they are long

    @property
    def numbers(self) -> Sequence[Table]:
        """All tables."""
        return [*self.tables, *self.folded]


def _option(key: str, value: Any) -> str:
    """One option of a study in words."""
    if key == "whole_team":
        return "one draw for the whole team" if value else "a draw per agent"
    return f"{key.replace('_', ' ')} {value}"


def heading(logs: StudyLogs) -> str:
    """What is studied: the scenario, unless the variants are of several."""
    return f"{logs.base.name}: {logs.kind}" if len(_names(logs)) == 1 else logs.kind.capitalize()


def _names(logs: StudyLogs) -> list[str]:
    """Scenarios of the variants."""
    return list(dict.fromkeys(run.name for run in logs.runs.values()))


def maps(logs: StudyLogs) -> list[str]:
    """Names of the maps of the variants."""
    return list(dict.fromkeys(run.map.name for run in logs.runs.values()))


def _what(logs: StudyLogs) -> list[tuple[str, str]]:
    """Scenario and map, or those of all variants."""
    names, run = _names(logs), logs.base
    scenario = ("Scenario", run.name) if len(names) == 1 else ("Scenarios", ", ".join(names))
    if len(maps(logs)) == 1:
        return [scenario, ("Map", map_words(run))]
    return [scenario, ("Maps", ", ".join(maps(logs)))]


def facts(logs: StudyLogs) -> list[tuple[str, str]]:
    """What was run, as pairs of a term and its value."""
    run, info = logs.base, logs.info
    policies = style.ordered(policy for one in logs.runs.values() for policy in one.policies)
    options = ", ".join(_option(key, value) for key, value in logs.options.items())
    pairs = [
        *_what(logs),
        ("Horizon", " or ".join(dict.fromkeys(map(horizon_words, logs.runs.values())))),
        ("Worlds", ", ".join(logs.worlds)),
        ("Policies", ", ".join(policies)),
        ("Variants", str(len(logs.runs))),
        ("Episodes", f"{info.episodes} for each variant, policy and world, seed {info.seed}"),
        ("Options", options),
        ("Started", info.started),
        ("Commit", info.commit),
        ("Versions", ", ".join(f"{name} {number}" for name, number in run.versions.items())),
    ]
    return [(term, value) for term, value in pairs if value]


def scene_sections(logs: StudyLogs) -> list[Section]:
    """Map, starts and items of the scenario as it is; nothing where no replay was kept."""
    replay = pick_replay(logs.whole)
    if replay is None:
        return []
    with house_style():
        return [Section("scene", "Scenario", "", (), [scenario_figure(logs.whole, replay)])]


def clearing_section(logs: StudyLogs) -> Section:
    """Whether the map was cleared in the scenario as it is, and what horizon would do."""
    table = clearing_table(logs.whole)
    words = f"Of the variant “{logs.title(logs.first)}”."
    if table is None:
        return Section(CLEARING, TITLE, f"{words} Every policy cleared the map every time.")
    return Section(CLEARING, TITLE, words, [table])


def cost_sections(logs: StudyLogs) -> list[Section]:
    """What the study took; nothing where it was not noted."""
    if not any(logs.costs.values()):
        return []
    drawn = [picture for picture in (throughput_picture(logs),) if picture is not None]
    tables = [cost_table(logs), throughput_table(logs)]
    return [Section("cost", "Cost and throughput", "", tables, drawn)]


def render(logs: StudyLogs, sections: Sequence[Section], notes: Sequence[str]) -> str:
    """Set the page as HTML, below 5 MB, and save its figures in the study's folder.

    Tables have fewer rows where they leave no room for figures, and say so.
    """
    rows = ROWS
    room = LARGEST - len(_set(logs, sections, notes, rows))
    while room < FIGURES and rows > FEWEST_ROWS:
        rows //= 2
        room = LARGEST - len(_set(logs, sections, notes, rows))
    pictures = [picture for section in sections for picture in section.pictures]
    figures = embedded_within(min(FIGURES, room), pictures, logs.folder)
    left = room - sum(len(figure.source) for figure in figures)
    replay = web_replay({"": logs.whole.folder}, min(BUDGET, left))
    return _set(logs, sections, notes, rows, figures, replay)


def _set(
    logs: StudyLogs,
    sections: Sequence[Section],
    notes: Sequence[str],
    rows: int,
    figures: Sequence[EmbeddedFigure] = (),
    replay: WebReplay | None = None,
) -> str:
    """The page with at most so many rows in a table, and the figures of all sections in turn."""
    parts: list[dict[str, Any]] = []
    drawn = iter(figures)
    for section in sections:
        shown = list(islice(drawn, len(section.pictures)))
        parts.append(
            {
                "name": section.name,
                "title": section.title,
                "words": section.words,
                "tables": [cut(table, rows, ALL) for table in section.tables],
                "folded": [cut(table, rows, ALL) for table in section.folded],
                "wide": [figure for figure in shown if figure.wide],
                "narrow": [figure for figure in shown if not figure.wide],
            }
        )
    content: dict[str, Any] = {
        "logs": logs,
        "heading": heading(logs),
        "maps": maps(logs),
        "facts": facts(logs),
        "variants": [
            (name, logs.title(name), ", ".join(run.policies)) for name, run in logs.runs.items()
        ],
        "sections": parts,
        "replay": replay,
        "few": too_few(logs.info.episodes),
        "first_with_numbers": next(
            (one["name"] for one in parts if one["tables"] and one["name"] != CLEARING), ""
        ),
        "notes": notes,
        "scenario_json": json.dumps(logs.info.scenario, indent=2, ensure_ascii=False),
    }
    return render_page("study.html.j2", logs.base.versions.get("mjforage", ""), content)
