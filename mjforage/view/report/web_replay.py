"""The page's interactive replay: the recorded episodes of one run, or of several."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup
from matplotlib.colors import to_hex

from mjforage.base.errors import UserError
from mjforage.physics.vessels import load_vessel
from mjforage.runs.episode_recording import Recording
from mjforage.runs.run_info import REMEDY, RunInfo
from mjforage.runs.selection import ranks_of, recording_files
from mjforage.scenario.vessel_files import vessel_names
from mjforage.view.page import style
from mjforage.view.report.run_logs import Case, RunLogs
from mjforage.view.report.web_entry import (
    IDLE_LEVELS,
    POSITION_M,
    WIND_MPS,
    YAW_RAD,
    entry_of,
)

BUDGET = 2_000_000  # characters of text for all replays of a page, which is to stay below 5 MB
MOST, MOST_STEPS = 120, 40_000  # episodes that are read for a page, and steps of all of them
HULL_M = 2.0  # length drawn for a user's vessel in a run at graph level
SCRIPTS = tuple(
    f"{name}.js" for name in ("decode", "choice", "harbour", "draw", "camera", "legend", "player")
)
COLOURS = {
    "water": style.WATER,
    "land": style.LAND,
    "edge": style.QUAY_EDGE,
    "item": style.ITEM,
    "rim": style.ITEM_RIM,
    "ink": style.INK,
    "scout": style.SCOUT,
    "forager": style.FORAGER,
    "lost": style.LOST,
}


@dataclass(frozen=True)
class WebReplay:
    """Parts of the player that the template sets."""

    panels: tuple[bool, ...]  # one or two, and whether each is shown at first
    vessels: tuple[str, ...]  # names
    held: bool  # True if each has a belief of its own
    left_out: int  # recorded episodes for which the page has no room
    data: Mapping[str, Any]  # for the page's script, as JSON
    script: Markup  # all of its element, to the letter: the page allows no other
    stylesheet: Markup


@dataclass(frozen=True)
class _File:
    """A recorded episode on disk."""

    place: int  # of its run among those of the page
    case: Case
    episode: int
    path: Path

    def entry(self, limit: int) -> dict[str, Any]:
        """Its data in so many characters if it can; read anew, as all are many.

        Raises
        ------
        UserError
            If the recording is not of the run.
        """
        recording, case, run = Recording.load(self.path), self.case, self.case.logs.run
        found = recording.world, recording.policy, recording.episode
        fits = found == (case.world, case.policy, self.episode)
        fits &= recording.agent_collects.tolist() == case.logs.collects()
        if not (fits and np.array_equal(recording.navigable, run.map.cells)):
            folder = case.logs.folder
            raise UserError(f"recording {self.path}: is not of the run in {folder}; {REMEDY}")
        ranks = ranks_of(case.values("pta_c"), case.values("length")) if run.episodes > 1 else {}
        own = [rank for rank, episode in ranks.items() if episode == self.episode]
        return entry_of(recording, limit) | {"run": self.place, "ranks": own}


def _facts(label: str, run: RunInfo, first: Path) -> dict[str, Any]:
    """Fleet and time of a run, by its first recording; hulls are as long as they ran."""
    recording = Recording.load(first)
    ran, shipped = run.hull_lengths, vessel_names()
    lengths = [
        ran.get(name) or (load_vessel(name).length_m if name in shipped else HULL_M)
        for name in recording.vessels
    ]
    colours = style.agent_colours(style.role(one.collects) for one in run.agents)
    return {
        "label": label,
        "seed": run.seed,
        "period_s": recording.period_s,
        "horizon": recording.horizon,
        "agents": [
            {"name": one.name, "collects": one.collects, "colour": colour, "length_m": length}
            for one, colour, length in zip(run.agents, colours, lengths, strict=True)
        ],
    }


def web_replay(runs: Mapping[str, RunLogs], budget: int = BUDGET) -> WebReplay | None:
    """Gather the recorded episodes of runs on one map; None if there are none, or none has room.

    Parameters
    ----------
    runs : label, as the player names it -> run; one run alone needs none: `{"": logs}`
    budget : characters of text for all episodes together; they are thinned in time to fit, and what
        does not fit even so is left out, the first episodes last

    Raises
    ------
    UserError
        If a file cannot be read, or a recording is of another run.
    """
    files = [
        _File(place, case, episode, path)
        for place, logs in enumerate(runs.values())
        for case in logs.cases
        for episode, path in recording_files(logs.folder, case.world, case.policy).items()
    ]
    longest = max((logs.run.horizon for logs in runs.values()), default=1)
    entries = _fitting(files, max(1, min(MOST, MOST_STEPS // longest)), budget)
    if not entries:
        return None
    shown, first = {entry["run"] for entry in entries}, {one.place: one.path for one in files[::-1]}
    facts = [
        _facts(label, logs.run, first[place]) if place in shown else None
        for place, (label, logs) in enumerate(runs.items())
    ]
    agents = [agent["name"] for one in facts if one for agent in one["agents"]]
    two = len(shown) > 1 or len({entry["world"] for entry in entries}) > 1
    code = [_part(name) for name in SCRIPTS]
    return WebReplay(
        panels=(True, two)[: 1 + (len(entries) > 1)],
        vessels=tuple(dict.fromkeys(agents)),
        held=any(entry["forgetting"] is not None for entry in entries),
        left_out=len(files) - len(entries),
        data={
            **_stage(next(iter(runs.values())).run),
            "runs": facts,
            "replays": entries,
        },
        script=Markup("\n".join(['(() => {\n"use strict";', *code, "})();"])),
        stylesheet=Markup(_part("player.css")),
    )


def _fitting(files: Sequence[_File], most: int, budget: int) -> list[dict[str, Any]]:
    """Entries of the page in the order of the files: each has its share of the budget.

    Where not all fit, one of each run, world and policy comes first, then further ones.
    """
    before: Counter[tuple[int, Case]] = Counter()
    turns = []
    for number, file in enumerate(files):
        turns.append((before[file.place, file.case], number))
        before[file.place, file.case] += 1
    first = sorted(turns)[:most]
    found: dict[int, dict[str, Any]] = {}
    for count, (_, number) in enumerate(first):
        entry = files[number].entry(max(1, budget // (len(first) - count)))
        budget -= len(entry["text"])
        if budget < 0:
            break
        found[number] = entry
    return [found[number] for number in sorted(found)]


def _part(name: str) -> str:
    file = resources.files("mjforage.view.report").joinpath("player", name)
    return file.read_text(encoding="utf-8")


def _stage(run: RunInfo) -> dict[str, Any]:
    """Map, units and colours, which all replays of a page share."""
    cells = run.map.cells
    height, width = cells.shape
    rows, columns = (np.flatnonzero(cells.any(axis=axis)) for axis in (1, 0))
    belief = style.belief_colours()
    return {
        "rows": height,
        "columns": width,
        "extent": {  # the water and one cell around it
            "top": max(0, int(rows[0]) - 1),
            "bottom": min(height - 1, int(rows[-1]) + 1),
            "left": max(0, int(columns[0]) - 1),
            "right": min(width - 1, int(columns[-1]) + 1),
        },
        "water": "".join("01"[int(cell)] for cell in cells.ravel()),
        "pitch_m": run.map.pitch_m,
        "units": {"position_m": POSITION_M, "yaw_rad": YAW_RAD, "wind_mps": WIND_MPS},
        "idle_levels": IDLE_LEVELS,
        "colours": COLOURS
        | {"belief": [to_hex(belief(at)) for at in np.linspace(style.FIRST, 1.0, 12)]},
    }
