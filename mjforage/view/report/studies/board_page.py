"""The board as one Markdown page for the documentation, with two figures beside it."""

import shlex
from collections.abc import Sequence
from importlib import resources
from pathlib import Path

import jinja2

from mjforage.base.atomic_files import write_bytes
from mjforage.base.errors import UserError
from mjforage.metrics import FEWEST
from mjforage.view.page.figure import ReportFigure, house_style, png_bytes, smaller
from mjforage.view.page.table_files import markdown_text
from mjforage.view.report.report_page import versions_words
from mjforage.view.report.sections import Section
from mjforage.view.report.studies import board
from mjforage.view.report.studies.study_logs import StudyLogs, load_study

ENOUGH = 100  # episodes of a board that is meant to be read


def write_board_page(folder: Path, page: Path) -> Path:
    """Write the Markdown page of the board in a folder, and its figures as PNG beside it.

    Raises `UserError` if the folder holds no finished board, or a file cannot be written.
    """
    logs = load_study(folder)
    if logs.info.kind != "board":
        raise UserError(
            f"--page {page}: is for a board; {folder} holds a study of {logs.info.kind}"
        )
    sections = board.sections(logs)
    pictures = {one.name: one for section in sections for one in section.pictures}
    for picture in pictures.values():
        with house_style():
            content = png_bytes(picture.figure)
        write_bytes(page.with_name(_file(page, picture.file)), smaller(content))
    write_bytes(page, page_text(logs, sections, page).encode("utf-8"))
    return page


def _file(page: Path, picture: str) -> str:
    return f"{page.stem}-{picture}.png"


def command_of(logs: StudyLogs) -> str:
    """The command that made the study, without the folder that it was given; words on Python."""
    if not logs.info.command.startswith("mjforage "):
        return f"# {logs.info.command}"
    words = shlex.split(logs.info.command)
    places = {place + end for place, word in enumerate(words) if word == "--out" for end in (0, 1)}
    kept = [
        word
        for place, word in enumerate(words)
        if place not in places and not word.startswith("--out=")
    ]
    return shlex.join(kept)


def page_text(logs: StudyLogs, sections: Sequence[Section], page: Path) -> str:
    """The page."""
    info = logs.info
    frame = resources.files("mjforage.view").joinpath("report", "board.md.j2")
    template = jinja2.Template(
        frame.read_text(encoding="utf-8"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        keep_trailing_newline=True,
    )
    text: str = template.render(
        command=command_of(logs),
        commit=info.commit,
        enough=ENOUGH,
        episodes=info.episodes,
        fewest=FEWEST,
        sections="\n\n".join(_section(section, page) for section in sections if not section.empty),
        seed=info.seed,
        started=info.started,
        versions=versions_words(logs.base),
    )
    return text


def _section(section: Section, page: Path) -> str:
    parts = [f"## {section.title}", *([section.words] if section.words else [])]
    parts += [markdown_text(table).strip() for table in section.tables if table.rows]
    parts += [_figure(picture, page) for picture in section.pictures]
    for table in section.folded:
        summary = f"<details><summary>{len(table.rows)} rows</summary>"
        parts += [summary, markdown_text(table).strip(), "</details>"]
    return "\n\n".join(parts)


def _figure(picture: ReportFigure, page: Path) -> str:
    return f"![{picture.title}]({_file(page, picture.file)})\n\n{picture.caption}"
