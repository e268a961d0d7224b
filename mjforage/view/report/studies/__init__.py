"""One page for a study: all its variants in tables and figures, from their logs."""

from dataclasses import replace
from pathlib import Path

from mjforage.base.errors import UserError
from mjforage.runs.run_info import AGAIN
from mjforage.view.report.exports import NOTHING_ELSE, Exports, write_page
from mjforage.view.report.published import NUMBERS
from mjforage.view.report.report_page import NOTES, notes_section
from mjforage.view.report.sections import Section
from mjforage.view.report.studies import (
    ablation,
    board,
    communication,
    corruption,
    paper,
    sensing,
)
from mjforage.view.report.studies.study_logs import load_study
from mjforage.view.report.studies.study_page import (
    opening_sections,
    settings_section,
    study_page,
)

__all__ = ["is_study", "write_study_report"]

PAGES = {
    "ablation": ablation.sections,
    "corruption": corruption.sections,
    "paper": paper.sections,
    "communication": communication.sections,
    "sensing": sensing.sections,
    "board": board.sections,
}
"""Kind of study -> what makes the sections of its page."""

LIKE_PAPER = ("ablation", "corruption", "paper")  # studies that play its variants
TRAINED = (
    "`ddqn` and `ddqn-link` were trained on demonstrations of `belief`. The paper's network (DRL) "
    "learnt from reward alone, and stands beside its like, `ddqn-reward`."
)


def is_study(folder: Path) -> bool:
    """True if a folder holds a study rather than a run."""
    return (folder / "study.json").is_file()


def numbered(section: Section) -> Section:
    """The section with the paper's numbers in titles of figures that show the same quantity."""
    return replace(
        section,
        pictures=[
            replace(one, title=f"{one.title} (paper's {NUMBERS[one.name]})")
            if one.name in NUMBERS
            else one
            for one in section.pictures
        ],
    )


def write_study_report(folder: Path, wanted: Exports = NOTHING_ELSE) -> Path:
    """Write ``figures/*.png|svg``, ``report.html`` and optional files into a study folder.

    Nothing is simulated, and the same logs give the same bytes. Raises `UserError` if a log is
    missing, truncated, foreign or incomplete, or the folder cannot be written.
    """
    logs = load_study(folder)
    if logs.info.kind not in PAGES:
        raise UserError(
            f"{folder / 'study.json'}: kind {logs.info.kind!r} is not one of {', '.join(PAGES)}; "
            f"{AGAIN}"
        )
    notes: tuple[str, ...] = NOTES
    sections = [*opening_sections(logs), *PAGES[logs.info.kind](logs)]
    if logs.info.kind in LIKE_PAPER:
        notes, sections = (TRAINED, *NOTES), list(map(numbered, sections))
    page = study_page(logs, [*sections, notes_section(notes), settings_section(logs)])
    return write_page(folder, page, logs.whole, wanted)
