"""The page's interactive replay: the recorded episodes of a run."""

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
from mjforage.view.report.web_entry import IDLE_LEVELS, POSITION_M, WIND_MPS, YAW_RAD, entry_of

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

    case: Case
    episode: int
    path: Path

    def entry(self, limit: int) -> dict[str, Any]:
        """Its data in so many characters if it can; read anew, as all are many.

        Raises `UserError` if the recording is not of the run.
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
        return entry_of(recording, limit) | {"ranks": own}


def _facts(run: RunInfo, first: Path) -> dict[str, Any]:
    """Fleet and time of a run, by its first recording; hulls are as long as they ran."""
    recording = Recording.load(first)
    ran, shipped = run.hull_lengths, vessel_names()
    lengths = [
        ran.get(name) or (load_vessel(name).length_m if name in shipped else HULL_M)
        for name in recording.vessels
    ]
    colours = style.agent_colours(style.role(one.collects) for one in run.agents)
    return {
        "period_s": recording.period_s,
        "horizon": recording.horizon,
        "agents": [
            {"name": one.name, "collects": one.collects, "colour": colour, "length_m": length}
            for one, colour, length in zip(run.agents, colours, lengths, strict=True)
        ],
    }


def web_replay(logs: RunLogs, budget: int = BUDGET) -> WebReplay | None:
    """Gather the recorded episodes of a run; None if there are none, or none has room.

    Raises `UserError` if a file cannot be read, or a recording is of another run.

    `budget`: characters of text for all episodes together; they are thinned in time to fit, and
    what does not fit even so is left out, the first episodes last.
    """
    files = [
        _File(case, episode, path)
        for case in logs.cases
        for episode, path in recording_files(logs.folder, case.world, case.policy).items()
    ]
    entries = _fitting(files, max(1, min(MOST, MOST_STEPS // logs.run.horizon)), budget)
    if not entries:
        return None
    facts = _facts(logs.run, files[0].path)
    two = len({entry["world"] for entry in entries}) > 1
    code = [_part(name) for name in SCRIPTS]
    return WebReplay(
        panels=(True, two)[: 1 + (len(entries) > 1)],
        vessels=tuple(agent["name"] for agent in facts["agents"]),
        held=any(entry["forgetting"] is not None for entry in entries),
        left_out=len(files) - len(entries),
        data={
            **_stage(logs.run),
            "run": facts,
            "replays": entries,
        },
        script=Markup("\n".join(['(() => {\n"use strict";', *code, "})();"])),
        stylesheet=Markup(_part("player.css")),
    )


def _fitting(files: Sequence[_File], most: int, budget: int) -> list[dict[str, Any]]:
    """Entries of the page in the order of the files: each has its share of the budget.

    Where not all fit, one of each world and policy comes first, then further ones.
    """
    before: Counter[Case] = Counter()
    turns = []
    for number, file in enumerate(files):
        turns.append((before[file.case], number))
        before[file.case] += 1
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
    """Map, units and colours, which all replays share."""
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
