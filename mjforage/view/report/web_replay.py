"""What the page's interactive replay shows: the kept episodes of one run, or of several."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from markupsafe import Markup
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.physics.vessels import load_vessel
from mjforage.runs.episode_recording import Recording
from mjforage.runs.kept import ranked, replay_files
from mjforage.runs.parquet import read_parquet
from mjforage.runs.run_info import REMEDY, RunInfo, load_run
from mjforage.scenario.vessel_files import vessel_names
from mjforage.view.page import style
from mjforage.view.report.run_logs import Series, load_episodes, scalar
from mjforage.view.report.step_means import KEYS
from mjforage.view.report.web_entry import (
    IDLE_LEVELS,
    POSITION_M,
    WIND_MPS,
    YAW_RAD,
    cut_entry,
    entry_of,
    fair_share,
)
from mjforage.view.report.web_stream import Ints

BUDGET = 2_000_000  # characters of text for all replays of a page, which is to stay below 5 MB
MOST, MOST_STEPS = 120, 40_000  # episodes that are read for a page, and steps of all of them
HULL_M = 2.0  # length drawn for a user's vessel in a run at graph level
SCRIPTS = (
    "decode.js",
    "choice.js",
    "harbour.js",
    "draw.js",
    "camera.js",
    "legend.js",
    "player.js",
)


@dataclass(frozen=True)
class WebReplay:
    """What the template sets."""

    panels: tuple[bool, ...]  # one or two, and whether each is shown at first
    vessels: tuple[str, ...]  # names
    held: bool  # whether each knows what it has heard only
    left_out: int  # kept episodes for which the page has no room
    cut: int  # shown ones that end early, for the same reason
    data: Mapping[str, Any]  # for the page's script, as JSON
    script: Markup  # all of its element, to the letter: the page allows no other
    stylesheet: Markup


@dataclass(frozen=True)
class _File:
    """A kept episode on disk."""

    run: "_Run"
    series: Series
    episode: int
    path: Path

    def entry(self, limit: int | None = None, cut_to: int | None = None) -> dict[str, Any]:
        """It for the page; read anew each time, as all of them would fill the memory."""
        replay = Recording.load(self.path)
        discovered = self.run.discovered(self, replay)
        found = entry_of(replay, discovered, limit)
        if cut_to is not None:
            found = cut_entry(replay, discovered, cut_to)
        return found | {"run": self.run.place, "ranks": self.run.ranks(self)}


@dataclass(frozen=True)
class _Run:
    """A run whose kept episodes are shown."""

    place: int  # among the runs of the page
    label: str
    folder: Path
    run: RunInfo
    policies: Sequence[str]  # that are shown; none for all

    @cached_property
    def files(self) -> tuple[_File, ...]:
        """Worlds outermost, then policies in their fixed order, then episodes."""
        policies = style.ordered(self.policies or self.run.policies)
        return tuple(
            _File(self, (world, policy), episode, path)
            for world in self.run.worlds
            for policy in policies
            for episode, path in replay_files(self.folder, world, policy).items()
        )

    @cached_property
    def collects(self) -> list[bool]:
        """Whether each agent collects: (agent,)."""
        return [agent.collects for agent in self.run.agents]

    @cached_property
    def _items(self) -> pl.DataFrame:
        """Logged discoveries of the kept episodes."""
        kept = pl.col("episode").is_in({file.episode for file in self.files})
        columns = (*KEYS, "item", "t_discovered")
        return read_parquet(self.folder / "items.parquet", columns, kept, REMEDY)

    @cached_property
    def _episodes(self) -> pl.DataFrame:
        return load_episodes(self.folder, self.run)

    def ranks(self, file: _File) -> list[str]:
        """What the episode is among those of its world and policy; nothing if it is the only."""
        world, policy = file.series
        rows = self._episodes.filter(world=world, policy=policy)
        if rows.height < 2:
            return []
        found = ranked(scalar(rows, "pta_c"), scalar(rows, "length"))
        return [rank for rank, episode in found.items() if episode == file.episode]

    def discovered(self, file: _File, replay: Recording) -> Ints:
        """Step of every item's discovery as logged, one step past the end if never.

        Raises
        ------
        UserError
            If the replay is not of the run.
        """
        world, policy = file.series
        rows = self._items.filter(world=world, policy=policy, episode=file.episode).sort("item")
        fits = (
            np.array_equal(replay.navigable, self.run.map.cells)
            and replay.agent_collects.tolist() == self.collects
            and len(rows) == replay.item_present.shape[1]
            and (replay.world, replay.policy) == file.series
            and replay.episode == file.episode
        )
        if not fits:
            raise UserError(f"replay {file.path}: is not of the run in {self.folder}; {REMEDY}")
        never = len(replay.item_present)
        step: Ints = rows["t_discovered"].cast(pl.Int64).fill_null(never).to_numpy()
        return np.minimum(step, never)

    def facts(self) -> dict[str, Any]:
        """It for the page: its fleet and its time."""
        replay = Recording.load(self.files[0].path)
        looks = zip(
            self.run.agents,
            style.agent_colours(map(style.role, self.collects)),
            self._lengths(replay),
            strict=True,
        )
        return {
            "label": self.label,
            "seed": self.run.seed,
            "period_s": replay.period_s,
            "horizon": replay.horizon,
            "agents": [
                {"name": one.name, "collects": one.collects, "colour": colour, "length_m": length}
                for one, colour, length in looks
            ],
        }

    def _lengths(self, replay: Recording) -> list[float]:
        """Hull length of every vessel [m]: as it was run, else as shipped."""
        ran, shipped = self.run.hull_lengths, vessel_names()
        return [
            ran.get(name) or (load_vessel(name).length_m if name in shipped else HULL_M)
            for name in replay.vessels
        ]


def web_replay(
    folders: Mapping[str, Path], budget: int = BUDGET, policies: Sequence[str] = ()
) -> WebReplay | None:
    """Gather the replays that runs on one map keep; None if they keep none.

    Parameters
    ----------
    folders : label, as the player names it -> run folder; one run alone needs none: `{"": folder}`
    budget : characters of text for all replays together; they are thinned in time to fit, and what
        does not fit even so is left out, the first episodes last; one that alone does not fit is
        cut after so many steps that it does
    policies : whose are shown; none for all

    Raises
    ------
    UserError
        If a file cannot be read, a replay is of another run, or the maps differ.
    """
    opened = [
        _Run(place, label, folder, load_run(folder / "run.json"), policies)
        for place, (label, folder) in enumerate(folders.items())
    ]
    for run in opened[1:]:
        _check_map(opened[0], run)
    kept = [file for run in opened for file in run.files]
    if not kept:
        return None
    longest = max(run.run.horizon for run in opened)
    files = _first_of_each(kept, max(1, min(MOST, MOST_STEPS // longest)))
    runs = list({file.run.place: file.run for file in files}.values())
    entries = _fitting(files, budget)
    worlds = {entry["world"] for entry in entries}
    agents = [agent.name for run in runs for agent in run.run.agents]
    facts = {run.place: run.facts() for run in runs}
    return WebReplay(
        panels=(True, len(worlds) > 1 or len(runs) > 1)[: 1 + (len(entries) > 1)],
        vessels=tuple(dict.fromkeys(agents)),
        held=any(entry["forgetting"] is not None for entry in entries),
        left_out=len(kept) - len(entries),
        cut=sum("whole" in entry for entry in entries),
        data={
            **_stage(runs[0].run),
            "runs": [facts.get(run.place) for run in opened],
            "replays": entries,
        },
        script=Markup("\n".join(['(() => {\n"use strict";', *map(_part, SCRIPTS), "})();"])),
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


def _first_of_each(files: Sequence[_File], most: int) -> list[_File]:
    """So many in their order: first one of each world and policy, then further ones."""
    place: dict[tuple[int, Series], int] = {}
    turn = []
    for file in files:
        key = file.run.place, file.series
        place[key] = place.get(key, -1) + 1
        turn.append(place[key])
    chosen = sorted(range(len(files)), key=lambda i: turn[i])[:most]
    return [files[i] for i in sorted(chosen)]


def _fitting(files: Sequence[_File], budget: int) -> list[dict[str, Any]]:
    """Entries of the page, thinned to fit; of those that do not fit first episodes go last."""
    few = budget // len(files)  # each may have so much whatever the others need
    entries, sizes = {}, []
    for i, file in enumerate(files):
        entry = file.entry()
        sizes.append(len(entry["text"]))
        if sizes[-1] <= few:
            entries[i] = entry
    limit = fair_share(sizes, budget)
    firsts = {(file.run.place, file.series): file.episode for file in reversed(files)}
    order = sorted(
        range(len(files)),
        key=lambda i: files[i].episode != firsts[files[i].run.place, files[i].series],
    )
    taken: dict[int, dict[str, Any]] = {}
    for i in order:
        entry = entries.get(i) or files[i].entry(limit)
        if not taken and len(entry["text"]) > budget:
            entry = files[i].entry(cut_to=budget)
        budget -= len(entry["text"])
        if taken and budget < 0:
            break
        taken[i] = entry
    return [taken[i] for i in sorted(taken)]


def _part(name: str) -> str:
    return (
        resources.files("mjforage.view.report").joinpath("player", name).read_text(encoding="utf-8")
    )


def _stage(run: RunInfo) -> dict[str, Any]:
    """What all replays of a page share."""
    cells = run.map.cells
    rows, columns = cells.shape
    belief = style.belief_colours()
    return {
        "rows": rows,
        "columns": columns,
        "extent": _extent(cells),
        "water": "".join("01"[int(cell)] for cell in cells.ravel()),
        "pitch_m": run.map.pitch_m,
        "units": {"position_m": POSITION_M, "yaw_rad": YAW_RAD, "wind_mps": WIND_MPS},
        "idle_levels": IDLE_LEVELS,
        "colours": {
            "water": style.WATER,
            "land": style.LAND,
            "edge": style.QUAY_EDGE,
            "item": style.ITEM,
            "rim": style.ITEM_RIM,
            "ink": style.INK,
            "scout": style.SCOUT,
            "forager": style.FORAGER,
            "lost": style.LOST,
            "belief": [_hex(belief(place)) for place in np.linspace(style.FIRST, 1.0, 12)],
        },
    }


def _extent(navigable: NDArray[np.bool_]) -> dict[str, int]:
    """Outermost rows and columns that are worth showing: the water and one cell around it."""
    rows, columns = (np.flatnonzero(navigable.any(axis=axis)) for axis in (1, 0))
    height, width = navigable.shape
    return {
        "top": max(0, int(rows[0]) - 1),
        "bottom": min(height - 1, int(rows[-1]) + 1),
        "left": max(0, int(columns[0]) - 1),
        "right": min(width - 1, int(columns[-1]) + 1),
    }


def _hex(colour: tuple[float, ...]) -> str:
    return "#" + "".join(f"{round(255 * part):02x}" for part in colour[:3])
