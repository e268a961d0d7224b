"""One page for a study: all its variants in tables and figures, from their logs.

Only what agents know and forecast is in no log: for pictures of it, episodes are played again.
"""

from pathlib import Path

from mjforage.base.atomic_files import write_bytes
from mjforage.base.errors import UserError
from mjforage.runs.run_info import again
from mjforage.view.report.exports import NOTHING_ELSE, Exports, export
from mjforage.view.report.report_page import definition_notes
from mjforage.view.report.studies import (
    ablation,
    board,
    communication,
    corruption,
    paper,
    planner_parts,
    sensing,
)
from mjforage.view.report.studies.as_in_paper import NOTE, referred
from mjforage.view.report.studies.cost import LIKE_PAPER
from mjforage.view.report.studies.study_logs import load_study
from mjforage.view.report.studies.study_page import (
    clearing_section,
    cost_sections,
    render,
    scene_sections,
)

__all__ = ["is_study", "write_study_report"]

PAGES = {
    "parts": planner_parts.sections,
    "ablation": ablation.sections,
    "corruption": corruption.sections,
    "paper": paper.sections,
    "communication": communication.sections,
    "sensing": sensing.sections,
    "board": board.sections,
}
"""Kind of study -> what makes the sections of its page."""


def is_study(folder: Path) -> bool:
    """Whether a folder holds a study rather than a run."""
    return (folder / "study.json").is_file()


def write_study_report(folder: Path, wanted: Exports = NOTHING_ELSE) -> Path:
    """Write ``figures/*.png|svg``, ``report.html`` and what is wanted besides into a study folder.

    The same logs give the same bytes. Nothing is simulated, but for `communication` and `sensing`:
    there an episode or a few are played again, and shown if they come out as they were logged.

    Raises
    ------
    UserError
        If a log is missing, truncated, foreign or incomplete, or the folder cannot be written.
    """
    logs = load_study(folder)
    if logs.kind not in PAGES:
        raise UserError(
            f"{folder / 'study.json'}: kind {logs.kind!r} is not one of {', '.join(PAGES)}; "
            f"{again(folder, 'study.json')}"
        )
    target = folder / "report.html"
    found = PAGES[logs.kind](logs)
    sections = [*scene_sections(logs), clearing_section(logs), *found, *cost_sections(logs)]
    notes = definition_notes()
    if logs.kind in LIKE_PAPER:
        sections, notes = referred(sections), [NOTE, *notes]
    text = render(logs, sections, notes)
    tables = [table for section in sections for table in section.numbers]
    pictures = [picture for section in sections for picture in section.pictures]
    export(folder, tables, pictures, wanted)
    write_bytes(target, text.encode("utf-8"))
    return target
