"""One page for a study: all its variants in tables and figures, from their logs."""

from pathlib import Path

from mjforage.base.atomic_files import write_bytes
from mjforage.base.errors import UserError
from mjforage.runs.run_info import AGAIN
from mjforage.view.report.exports import NOTHING_ELSE, Exports, export
from mjforage.view.report.report_page import NOTES, notes_section
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
from mjforage.view.report.studies.study_logs import load_study
from mjforage.view.report.studies.study_page import (
    cost_section,
    opening_sections,
    settings_section,
    study_page,
)
from mjforage.view.report.web_replay import web_replay

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

LIKE_PAPER = ("ablation", "corruption", "paper")  # studies that play its variants


def is_study(folder: Path) -> bool:
    """True if a folder holds a study rather than a run."""
    return (folder / "study.json").is_file()


def write_study_report(folder: Path, wanted: Exports = NOTHING_ELSE) -> Path:
    """Write ``figures/*.png|svg``, ``report.html`` and optional files into a study folder.

    Nothing is simulated, and the same logs give the same bytes.

    Raises
    ------
    UserError
        If a log is missing, truncated, foreign or incomplete, or the folder cannot be written.
    """
    logs = load_study(folder)
    if logs.kind not in PAGES:
        raise UserError(
            f"{folder / 'study.json'}: kind {logs.kind!r} is not one of {', '.join(PAGES)}; {AGAIN}"
        )
    notes: tuple[str, ...] = NOTES
    sections = [*opening_sections(logs), *PAGES[logs.kind](logs), cost_section(logs)]
    if logs.kind in LIKE_PAPER:
        notes, sections = (NOTE, *NOTES), referred(sections)
    page = study_page(logs, [*sections, notes_section(notes), settings_section(logs)])
    text = page.text(folder, lambda room: web_replay({"": logs.whole.folder}, room))
    tables = [table for section in page.sections for table in section.numbers]
    pictures = [picture for section in page.sections for picture in section.pictures]
    export(folder, tables, pictures, wanted)
    target = folder / "report.html"
    write_bytes(target, text.encode("utf-8"))
    return target
