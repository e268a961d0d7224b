"""The page's interactive replay: the recorded episodes of one run, or of several."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from markupsafe import Markup
from matplotlib.colors import to_hex

from mjforage.base.errors import UserError
from mjforage.physics.vessels import load_vessel
from mjforage.runs.episode_recording import Recording
from mjforage.runs.run_info import REMEDY, RunInfo, load_run
from mjforage.runs.selection import ranks_of, recording_files
from mjforage.scenario.vessel_files import vessel_names
from mjforage.view.page import style
from mjforage.view.report.run_logs import load_episodes, scalar
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
    held: bool  # whether each has a belief of its own
    left_out: int  # recorded episodes for which the page has no room
    data: Mapping[str, Any]  # for the page's script, as JSON
    script: Markup  # all of its element, to the letter: the page allows no other
    stylesheet: Markup


@dataclass(frozen=True)
class _File:
    """A recorded episode on disk."""

    run: "_Run"
    world: str
    policy: str
    episode: int
    path: Path

    def entry(self, limit: int) -> dict[str, Any]:
        """Its data, thinned to so many characters if it can be; read anew, as all are many.

        Raises
        ------
        UserError
            If the recording is not of the run.
        """
        recording, run = Recording.load(self.path), self.run.run
        found = (
            recording.world,
            recording.policy,
            recording.episode,
            recording.agent_collects.tolist(),
        )
        collects = [agent.collects for agent in run.agents]
        fits = found == (self.world, self.policy, self.episode, collects)
        if not (fits and np.array_equal(recording.navigable, run.map.cells)):
            raise UserError(f"replay {self.path}: is not of the run in {self.run.folder}; {REMEDY}")
        entry = entry_of(recording, limit)
        return entry | {"run": self.run.place, "ranks": self.run.ranks(self)}


@dataclass(frozen=True)
class _Run:
    """A run whose recorded episodes are shown."""

    place: int  # among the runs of the page
    label: str
    folder: Path
    run: RunInfo
    policies: Sequence[str]  # that are shown; none for all

    @cached_property
    def files(self) -> tuple[_File, ...]:
        """Worlds outermost, then policies in their fixed order, then episodes."""
        return tuple(
            _File(self, world, policy, episode, path)
            for world in self.run.worlds
            for policy in style.ordered(self.policies or self.run.policies)
            for episode, path in recording_files(self.folder, world, policy).items()
        )

    @cached_property
    def _episodes(self) -> pl.DataFrame:
        return load_episodes(self.folder, self.run)

    def ranks(self, file: _File) -> list[str]:
        """Ranks of the episode in its world and policy; nothing if it is the only."""
        rows = self._episodes.filter(world=file.world, policy=file.policy)
        if rows.height < 2:
            return []
        found = ranks_of(scalar(rows, "pta_c"), scalar(rows, "length"))
        return [rank for rank, episode in found.items() if episode == file.episode]

    def facts(self) -> dict[str, Any]:
        """Fleet and time of the run; hulls are as long as they ran, else as shipped."""
        recording = Recording.load(self.files[0].path)
        ran, shipped = self.run.hull_lengths, vessel_names()
        lengths = [
            ran.get(name) or (load_vessel(name).length_m if name in shipped else HULL_M)
            for name in recording.vessels
        ]
        colours = style.agent_colours(style.role(one.collects) for one in self.run.agents)
        return {
            "label": self.label,
            "seed": self.run.seed,
            "period_s": recording.period_s,
            "horizon": recording.horizon,
            "agents": [
                {"name": one.name, "collects": one.collects, "colour": colour, "length_m": length}
                for one, colour, length in zip(self.run.agents, colours, lengths, strict=True)
            ],
        }


def web_replay(
    folders: Mapping[str, Path], budget: int = BUDGET, policies: Sequence[str] = ()
) -> WebReplay | None:
    """Gather the recorded episodes of runs on one map; None if there are none.

    Parameters
    ----------
    folders : label, as the player names it -> run folder; one run alone needs none: `{"": folder}`
    budget : characters of text for all replays together; they are thinned in time to fit, and what
        does not fit even so is left out, the first episodes last; one is always shown
    policies : whose are shown; none for all

    Raises
    ------
    UserError
        If a file cannot be read, a recording is of another run, or the maps differ.
    """
    opened = [
        _Run(place, label, folder, load_run(folder / "run.json"), policies)
        for place, (label, folder) in enumerate(folders.items())
    ]
    for run in opened[1:]:
        _check_map(opened[0], run)
    files = [file for run in opened for file in run.files]
    if not files:
        return None
    longest = max(run.run.horizon for run in opened)
    entries = _fitting(files, max(1, min(MOST, MOST_STEPS // longest)), budget)
    shown = {entry["run"] for entry in entries}
    facts = {run.place: run.facts() for run in opened if run.place in shown}
    agents = [agent["name"] for one in facts.values() for agent in one["agents"]]
    two = len(shown) > 1 or len({entry["world"] for entry in entries}) > 1
    code = [_part(name) for name in SCRIPTS]
    return WebReplay(
        panels=(True, two)[: 1 + (len(entries) > 1)],
        vessels=tuple(dict.fromkeys(agents)),
        held=any(entry["forgetting"] is not None for entry in entries),
        left_out=len(files) - len(entries),
        data={
            **_stage(opened[0].run),
            "runs": [facts.get(run.place) for run in opened],
            "replays": entries,
        },
        script=Markup("\n".join(['(() => {\n"use strict";', *code, "})();"])),
        stylesheet=Markup(_part("player.css")),
    )


def _check_map(first: _Run, other: _Run) -> None:
    here, there = first.run.map, other.run.map
    if here.pitch_m != there.pitch_m or not np.array_equal(here.cells, there.cells):
        raise UserError(
            f"{other.folder}: is on another map ({there.name}, {there.rows} x {there.columns} "
            f"nodes {there.pitch_m:g} m apart) than {first.folder} ({here.name}, {here.rows} x "
            f"{here.columns}, {here.pitch_m:g} m); name runs on one map"
        )


def _fitting(files: Sequence[_File], most: int, budget: int) -> list[dict[str, Any]]:
    """Entries of the page in the order of the files: each has its share of the budget.

    Where not all fit, one of each run, world and policy comes first, then further ones.
    """
    before: Counter[tuple[int, str, str]] = Counter()
    turns = []
    for place, file in enumerate(files):
        case = file.run.place, file.world, file.policy
        turns.append((before[case], place))
        before[case] += 1
    selected = sorted(turns)[:most]
    fitting: dict[int, dict[str, Any]] = {}
    for number, (_, place) in enumerate(selected):
        entry = files[place].entry(max(1, budget // (len(selected) - number)))
        budget -= len(entry["text"])
        if fitting and budget < 0:
            break
        fitting[place] = entry
    return [fitting[place] for place in sorted(fitting)]


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
