"""`report.html` of a run: what it is set from, and what it says of itself."""

import json
from collections.abc import Sequence
from typing import Any

from mjforage.runs.run_info import RunInfo
from mjforage.view.page import EmbeddedFigure, groups, render_page, style
from mjforage.view.report.all_tables import ReportTables
from mjforage.view.report.differences import too_few
from mjforage.view.report.run_logs import RunLogs
from mjforage.view.report.shown import LARGEST, cut, left_out
from mjforage.view.report.text_tables import minutes, number
from mjforage.view.report.web_replay import BUDGET, WebReplay, web_replay


def map_words(run: RunInfo) -> str:
    """Name and size of a run's map."""
    rows, columns = run.map.cells.shape
    pitch = f"{run.map.pitch_m:g} m"
    return f"{run.map.name}: {rows} × {columns}, {run.map.nodes} nodes {pitch} apart"


def horizon_words(run: RunInfo) -> str:
    """How long an episode of a run may take, in steps and minutes."""
    length_min = number(minutes(run, run.horizon), 0)
    return f"T = {run.horizon} steps of {run.period_s:g} s: {length_min} min"


def run_facts(logs: RunLogs) -> list[tuple[str, str]]:
    """What was run, as pairs of a term and its value."""
    run = logs.run
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
        ("Map", map_words(run)),
        ("Fleet", ", ".join(f"{count} {team}" for team, count in fleet.items()) or "no vessels"),
        ("Horizon", horizon_words(run)),
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


class ReportPage:
    """The whole report as HTML, below 5 MB.

    Parameters
    ----------
    logs, shown : the run, and what of it the page shows
    tables : of both

    Attributes
    ----------
    room : characters left for figures and replay
    """

    def __init__(self, logs: RunLogs, shown: RunLogs, tables: ReportTables) -> None:
        self._logs, self._shown = logs, shown
        self._version = logs.run.versions.get("mjforage", "")
        paired = cut(tables.paired)
        self._content: dict[str, Any] = {
            "run": logs.run,
            "left_out": left_out(logs, shown),
            "chips": {
                name: look.colour for name, look in style.policy_styles(shown.policies).items()
            },
            "facts": run_facts(logs),
            "headline": tables.headline,
            "few": too_few(logs.run.episodes),
            "papers": [cut(table) for table in tables.papers],
            "full": cut(tables.full),
            "paired": paired,
            "gap": [cut(table) for table in tables.gap],
            "hulls": cut(tables.hulls),
            "clearing": cut(tables.clearing),
            "pairs": len(groups(paired.rows)) if paired else 0,
            "notes": definition_notes(),
            "horizon_min": number(minutes(logs.run, logs.run.horizon), 0),
            "scenario_json": json.dumps(logs.run.scenario, indent=2, ensure_ascii=False),
        }
        self.room = LARGEST - len(self._set((), None))

    def text(self, figures: Sequence[EmbeddedFigure]) -> str:
        """The page with these figures, and as much of the replay as there is room for."""
        room = self.room - sum(len(figure.source) for figure in figures)
        folders = {"": self._logs.folder}
        return self._set(figures, web_replay(folders, min(BUDGET, room), self._shown.policies))

    def _set(self, figures: Sequence[EmbeddedFigure], replay: WebReplay | None) -> str:
        parts = {
            "wide": [figure for figure in figures if figure.wide],
            "narrow": [figure for figure in figures if not figure.wide],
            "replay": replay,
        }
        return render_page("report.html.j2", self._version, self._content | parts)
