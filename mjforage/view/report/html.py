"""`report.html`: one file with tables and figures inside it, nothing fetched from outside."""

import base64
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any

import jinja2
from markupsafe import Markup, escape

from mjforage.view.report import style
from mjforage.view.report.differences import too_few
from mjforage.view.report.picture import Picture
from mjforage.view.report.run_logs import RunLogs
from mjforage.view.report.text_tables import Row, Table
from mjforage.view.report.web_replay import web_replay

_SUBSCRIPT = re.compile(r"(?<![\w.:])([A-Z][A-Za-z]*)_([A-Za-z0-9]+)\b")  # of labels of metrics
_CODE = re.compile(r"`([^`]+)`")


@dataclass(frozen=True)
class Shown:
    """A figure as the template sets it."""

    name: str
    title: str
    caption: str
    source: str  # data URI
    wide: bool
    width_px: int  # CSS pixels at natural size
    height_px: int


def rich_text(text: str) -> Markup:
    """Escape, then set subscripts of metric names and code between backticks."""
    safe = str(escape(text))
    safe = _SUBSCRIPT.sub(r"\1<sub>\2</sub>", safe)
    return Markup(_CODE.sub(r"<code>\1</code>", safe))


def interval_text(text: str) -> Markup:
    """Escape, and set what follows ± or an opening parenthesis smaller."""
    for sign in (" ± ", " ("):
        mean, found, rest = text.partition(sign)
        if found:
            return Markup("{}<small>{}{}</small>").format(mean, sign, rest)
    return escape(text)


def groups(rows: Sequence[Row]) -> list[tuple[Row, list[Row]]]:
    """Consecutive rows of one group, each with its first row."""
    result: list[tuple[Row, list[Row]]] = []
    for row in rows:
        if result and result[-1][0].group == row.group:
            result[-1][1].append(row)
        else:
            result.append((row, [row]))
    return result


def shown(picture: Picture, png: bytes, svg: bytes) -> Shown:
    """Embed a figure as a data URI: curves as SVG, maps as the much smaller PNG."""
    kind, content = ("png", png) if picture.wide else ("svg+xml", svg)
    source = f"data:image/{kind};base64," + base64.b64encode(content).decode("ascii")
    width, height = (round(96 * size) for size in picture.figure.get_size_inches())
    return Shown(picture.name, picture.title, picture.caption, source, picture.wide, width, height)


def run_facts(logs: RunLogs) -> list[tuple[str, str]]:
    """What was run, as pairs of a term and its value."""
    run = logs.run
    rows, columns = run.map.cells.shape
    pitch = f"{run.map.pitch_m:g} m"
    fleet: dict[str, int] = {}
    for agent in run.agents:
        fleet[agent.team] = fleet.get(agent.team, 0) + 1
    each = "policy" if len(run.worlds) == 1 else "policy and world"
    timings = ", ".join(
        f"{key[:-2]} {value:.1f} s" if key.endswith("_s") else f"{key} {value:g}"
        for key, value in run.timings.items()
    )
    return [
        ("Scenario", run.name),
        ("Map", f"{run.map.name}: {rows} × {columns}, {run.map.nodes} nodes {pitch} apart"),
        ("Fleet", ", ".join(f"{count} {team}" for team, count in fleet.items()) or "no vessels"),
        ("Horizon", f"T = {run.horizon} steps"),
        ("Worlds", ", ".join(run.worlds)),
        ("Policies", ", ".join(logs.policies)),
        ("Episodes", f"{run.episodes} for each {each}, seed {run.seed}"),
        ("Started", run.started),
        ("Time spent", timings or "not logged"),
        ("Versions", ", ".join(f"{name} {version}" for name, version in run.versions.items())),
    ]


def definition_notes() -> list[str]:
    """Where our numbers follow another definition than the paper's printed ones."""
    return [
        "RMSE is taken over the navigable nodes, as the paper's equation says. The numbers it "
        "printed are the mean over the map's columns of each column's error, land included, about "
        "3.8 times smaller on its map; RMSE_columns repeats that.",
        "CSR is undefined in an episode with nothing removed, which is then left out and counted; "
        "the printed numbers count it as 0.",
        "ITL compares the steps of the largest rise of PTA_D and PTA_C, as the printed numbers do; "
        "ITL_level compares the maxima of the curves themselves, as the paper's text says.",
        "Idleness is reset by the views of all agents of both teams together. Series of an episode "
        "that ends early are padded with their last value, also for CO, as in the printed numbers.",
        "A node is seen at a distance up to and including the sensing radius; the paper's formula "
        "excludes that distance, its runs include it.",
        "Staying put is a legal action unless the scenario switches it off; the paper's runs had "
        "no such action.",
        "A policy marked (bound) is shown where the items are and how they drift: it tells how far "
        "from the possible the others are, and is left out where the best is picked.",
        "Episode i has the same items, weather and starts for every policy, so differences can be "
        "paired. In the paper's code the drift noise shared a stream with the policies' own draws.",
        "Undefined values (–) are left out of means and intervals; n counts what is left. With one "
        "episode there is no standard error.",
    ]


def environment() -> jinja2.Environment:
    """The templates with the filters that they use."""
    templates = jinja2.Environment(
        loader=jinja2.FunctionLoader(template),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    templates.filters["rich_text"] = rich_text
    templates.filters["interval_text"] = interval_text
    templates.filters["groups"] = groups
    return templates


def template(name: str) -> str:
    """Text of a template or style sheet."""
    return resources.files("mjforage.view.report").joinpath(name).read_text(encoding="utf-8")


def _chips(logs: RunLogs) -> Mapping[str, str]:
    return {name: look.colour for name, look in style.looks(logs.policies).items()}


def render(
    logs: RunLogs,
    figures: Sequence[Shown],
    headline: Table,
    papers: Sequence[Table],
    full: Table,
    paired: Table | None,
    gap: Sequence[Table] = (),
) -> str:
    """Set the whole report as HTML."""
    context: dict[str, Any] = {
        "run": logs.run,
        "chips": _chips(logs),
        "facts": run_facts(logs),
        "headline": headline,
        "few": too_few(logs.run.episodes),
        "wide": [figure for figure in figures if figure.wide],
        "narrow": [figure for figure in figures if not figure.wide],
        "papers": papers,
        "full": full,
        "paired": paired,
        "gap": gap,
        "pairs": len(groups(paired.rows)) if paired else 0,
        "notes": definition_notes(),
        "replay": web_replay(logs),
        "scenario_json": json.dumps(logs.run.scenario, indent=2, ensure_ascii=False),
        "stylesheet": Markup(template("report.css.j2")),
    }
    return environment().get_template("report.html.j2").render(context)
