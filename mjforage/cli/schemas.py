"""Command that writes JSON Schemas and the reference pages of files and commands."""

import importlib
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from mjforage.cli.console import FOLDER, app, print_list

_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_NOTE = "<!-- Written by `mjforage schemas --pages docs/reference`; edit the {} instead. -->"
_STARTED_AS = re.compile(r"^(mjforage [\w -]*?\w) -m \S+", re.MULTILINE)  # usage under `python -m`
COMMANDS = "command-line"  # name of the page of all commands


def schemas_of_files() -> Mapping[str, tuple[str, Any]]:
    """Name -> description of the file, and its schema."""
    from mjforage.learning.training.hyperparameters import Hyperparameters
    from mjforage.learning.training.mappo.hyperparameters import MappoHyperparameters
    from mjforage.learning.training.training_info import TrainingInfo
    from mjforage.physics.vessels import Vessel
    from mjforage.runs.costs import Costs
    from mjforage.runs.run_info import RunInfo
    from mjforage.runs.studies.study import StudyInfo
    from mjforage.scenario.capture import Capture
    from mjforage.scenario.debris import DebrisClass
    from mjforage.scenario.place import Place
    from mjforage.scenario.scenario import Scenario

    return {
        "scenario": ("a scenario file", Scenario),
        "vessel": ("a vessel file", Vessel),
        "capture": ("a vessel's capture model", Capture),
        "debris": ("a file of debris classes", dict[str, DebrisClass]),
        "place": ("`place.toml` of a place", Place),
        "run": ("`run.json` of a run folder", RunInfo),
        "costs": ("`costs.json` of a run folder", Costs),
        "study": ("`study.json` of a study folder", StudyInfo),
        "training": ("`training.json` of a training folder", TrainingInfo),
        "ddqn": ("`--learning` of `mjforage train ddqn`", Hyperparameters),
        "mappo": ("`--learning` of `mjforage train mappo`", MappoHyperparameters),
    }


@app.command
def schemas(*, out: Annotated[Path | None, FOLDER] = None, pages: Path | None = None) -> None:
    """List the kinds of files, or write schemas and reference pages of their keys.

    Parameters
    ----------
    out
        Folder for a JSON Schema of each, from which editors complete and check.
    pages
        Folder for a reference page of each, and of all commands, in Markdown.
    """
    from mjforage.base.atomic_files import write_bytes
    from mjforage.scenario.schema import page

    files = schemas_of_files()
    for name, (words, schema) in files.items():
        if out is not None:
            write_bytes(out / f"{name}.json", schema_text(name, schema).encode())
        if pages is not None:
            text = f"{_NOTE.format('dataclass')}\n# Keys of {words}\n\n{page(schema)}"
            write_bytes(pages / f"{name}.md", text.encode())
    if pages is not None:
        write_bytes(pages / f"{COMMANDS}.md", commands_page().encode())
    if out is None and pages is None:
        print_list((name, words.replace("`", "")) for name, (words, _) in files.items())


def schema_text(name: str, schema: Any) -> str:
    """The JSON Schema of a file as text."""
    from mjforage.scenario.scenario_file import with_extends
    from mjforage.scenario.schema import json_schema

    head = {"$schema": _DIALECT, "title": f"mjforage {name}"}
    tree = json_schema(schema)
    tree = with_extends(tree) if name == "scenario" else tree
    return json.dumps(head | {**tree, **head}, indent=1) + "\n"


def _in_order(text: str, level: str = "##") -> str:
    """Sections by their titles: commands are known in the order in which modules are imported."""
    head, *sections = re.split(rf"(?m)^(?={level} )", text)
    return head + "".join(sorted(_in_order(one, f"{level}#") for one in sections))


def commands_page() -> str:
    """Reference page of all commands and flags, from their docstrings."""
    importlib.import_module("mjforage.cli.running")  # has all commands known
    text = app.generate_docs(output_format="markdown", usage_name="mjforage")
    _, separator, commands = text.partition("\n**Commands**:\n")
    if not separator:
        raise ValueError("cyclopts' page has another form: no list of commands")
    sections = _in_order(_STARTED_AS.sub("\\1", commands.rstrip()) + "\n\n").rstrip()
    return f"{_NOTE.format('docstring of the command')}\n# Command line\n{sections}\n"
