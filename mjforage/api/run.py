"""A run: its tables as polars frames, differences, figures, frames of an episode, and films."""

import shutil
import tempfile
import weakref
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from mjforage.api.players import Players
from mjforage.api.scenarios import Named, Scenario
from mjforage.base.atomic_files import write_bytes, write_errors
from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.graph_planner.policies.registry import has_policy, own_weights
from mjforage.runs.evaluate import summarise
from mjforage.runs.replaying import recording_of_run
from mjforage.runs.run_info import load_run
from mjforage.runs.selection import recording_file
from mjforage.runs.storage import RunFolder
from mjforage.runs.tables import read_table
from mjforage.scenario.maps import GridMap
from mjforage.scenario.scenario_file import scenario_from_tree

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mjforage.runs.episode_recording import Recording
    from mjforage.view.page import Table
    from mjforage.view.report.run_logs import RunLogs

NOBODY = Players()


class Run:
    """Policies on the same episodes, in one world or several; made by `evaluate` and `load_run`.

    Tables are copies: what is done to them changes no run.

    Examples
    --------
    >>> import mjforage as mf
    >>> run = mf.evaluate("open-bay", "greedy", episodes=2, horizon=20)
    >>> run
    Run(open-bay, graph, greedy, 2 episodes, seed 0)
    >>> run.summary.filter(metric="pta_c").columns
    ['world', 'policy', 'metric', 'mean', 'low', 'high', 'sem', 'iqm', 'n']
    """

    def __init__(
        self,
        folder: Path,
        temporary: Path | None = None,
        players: Players = NOBODY,
        warnings: Sequence[str] = (),
    ) -> None:
        """Open a run folder; a temporary one around it goes when the run does."""
        self._players, self._warnings = players, tuple(warnings)
        self._folder, self._in_memory = folder, temporary is not None
        if temporary is not None:
            weakref.finalize(self, shutil.rmtree, temporary, ignore_errors=True)
        self._info = load_run(folder / "run.json")

    @property
    def folder(self) -> Path | None:
        """The run folder; None where the run is in memory alone."""
        return None if self._in_memory else self._folder

    @property
    def complete(self) -> bool:
        """True if all episodes are finished."""
        return RunFolder(self._folder).complete

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of the call that made the run, each a line; none of a run that was loaded."""
        return self._warnings

    @property
    def policies(self) -> tuple[str, ...]:
        """Policies in their order."""
        return self._info.policies

    @property
    def worlds(self) -> tuple[str, ...]:
        """Worlds in their order."""
        return self._info.worlds

    @property
    def seed(self) -> int:
        """Seed of the run."""
        return self._info.seed

    @cached_property
    def scenario(self) -> Scenario:
        """Scenario and map that were played."""
        where = str(self._folder / "run.json")
        scenario = scenario_from_tree(dict(self._info.scenario), where)
        return Scenario(scenario, GridMap(self._info.map.name, self._info.map.cells))

    @property
    def episodes(self) -> pl.DataFrame:
        """A row per world, policy and episode: items, and every metric."""
        return self._table("episodes")

    @property
    def steps(self) -> pl.DataFrame:
        """A row per world, policy, episode and step: the metrics over time."""
        return self._table("steps")

    @property
    def agents(self) -> pl.DataFrame:
        """A row per world, policy, episode, step and agent: place, move, energy, touches."""
        return self._table("agents")

    @property
    def items(self) -> pl.DataFrame:
        """A row per world, policy, episode and item: who discovered and collected it, and when."""
        return self._table("items")

    @property
    def summary(self) -> pl.DataFrame:
        """A row per world, policy and metric: mean, bootstrap 95 % interval, SEM, IQM, episodes."""
        rows = [
            {"world": world, "policy": policy, "metric": metric, "mean": one["mean"]}
            | {"low": one["ci95"][0], "high": one["ci95"][1]}
            | {key: one[key] for key in ("sem", "iqm", "n")}
            for world, policies in summarise(self.episodes).items()
            for policy, metrics in policies.items()
            for metric, one in metrics.items()
        ]
        return pl.DataFrame(rows, infer_schema_length=None)

    def differences(
        self,
        policy: str | None = None,
        against: str | None = None,
        *,
        world: str | tuple[str, str] | None = None,
        metrics: Sequence[str] = (),
    ) -> pl.DataFrame:
        """Paired differences over the same episodes, one row per metric (and policy or world).

        Parameters
        ----------
        policy, against : two policies of the run; with one and two worlds, that one in both;
            with none and two worlds, every policy
        world : a world, or (first, second): the second minus the first. By default every world,
            or between two policies each world
        metrics : keys; by default all that are defined

        Returns
        -------
        world, policy, metric, difference, its bootstrap 95 % interval (low, high), p of the paired
        test, the same by Holm's correction over the rows (p_holm), n episodes

        Raises
        ------
        UserError
            If there is no such policy, world or metric, or the run is not complete.
        """
        from mjforage.view.report.contrasts import Contrast
        from mjforage.view.report.differences import corrected
        from mjforage.view.report.run_logs import Case

        logs = self._logs
        pairs = [
            (
                f"{one} - {other}" if one != other else one,
                f"{here} - {there}" if here != there else here,
                Contrast("", Case(logs, here, one), Case(logs, there, other)),
            )
            for one, here, other, there in self._paired(policy, against, world)
        ]
        keys = [self._known("metric", key, logs.metrics) for key in metrics] or list(logs.metrics)
        found = [
            (where, who, key, gap)
            for who, where, contrast in pairs
            for key in keys
            if (gap := contrast.gap(logs.metrics[key])).n
        ]
        names = ("world", "policy", "metric", "difference", "low", "high", "p", "p_holm", "n")
        rows = [
            (where, who, key, gap.value, gap.low, gap.high, gap.p, p, gap.n)
            for (where, who, key, gap), p in zip(
                found, corrected([gap for *_, gap in found]), strict=True
            )
        ]
        return pl.DataFrame(rows, schema=names, orient="row")

    def _paired(
        self, policy: str | None, against: str | None, world: str | tuple[str, str] | None
    ) -> list[tuple[str, str, str, str]]:
        """Policy and world, and those that are subtracted."""
        for name in (policy, against):
            if name is not None:
                self._known("policy", name, self.policies)
        worlds = (world,) if isinstance(world, str) else world or ()
        for name in worlds:
            self._known("world", name, self.worlds)
        if len(worlds) == 2:
            chosen = [policy] if policy else list(self.policies)
            return [(one, worlds[1], against or one, worlds[0]) for one in chosen]
        if policy is None or against is None:
            raise UserError(
                'differences: give two policies, or two worlds as in world=("graph", "physics")'
            )
        return [(policy, one, against, one) for one in worlds or self.worlds]

    def plot(self, what: str = "progress") -> "Figure":
        """Draw a figure of the report: "progress", "tracks", or the name of another.

        Raises
        ------
        UserError
            If there is no such figure; the message names all.
        """
        from mjforage.view.report.report_page import draw_figures

        found = {one.name: one.figure for one in draw_figures(self._logs)}
        named = {"progress": "pta"}.get(what, what)
        return found[self._known("figure", named, found)]

    def report(self, path: Named | None = None) -> Path:
        """Write `report.html` with its tables and figures into the run folder, or a page alone.

        Parameters
        ----------
        path : file of the page; None: `report.html` of the run folder

        Raises
        ------
        UserError
            If the run is not complete, or a file cannot be written.
        """
        from mjforage.view.report import write_report

        self._check_complete()
        if path is None and self._in_memory:
            raise UserError('report: the run has no folder; give a path, as in "report.html"')
        if path is not None and Path(path).is_dir():
            raise UserError(f"report {path}: is a folder; give the name of a file")
        page = write_report(self._folder)
        if path is None:
            return page
        with write_errors(Path(path)):
            return Path(shutil.copyfile(page, Path(path)))

    def save(self, folder: Named) -> Path:
        """Copy the run into a folder that is not there yet, as the command line writes it.

        Raises
        ------
        UserError
            If there is something of that name.
        """
        target = Path(folder)
        if target.exists():
            raise UserError(f"folder {target}: is there already; name another")
        with write_errors(target):
            return Path(shutil.copytree(self._folder, target))

    def frame(
        self,
        policy: str | None = None,
        *,
        world: str | None = None,
        episode: int = 0,
        time_s: float = 0.0,
        **how: Any,
    ) -> NDArray[np.uint8]:
        """Picture of an episode at a time, drawn offscreen.

        Parameters
        ----------
        policy, world : of the run; by default its first
        time_s : simulated time
        how : camera, follow, seen_by, size, as of `film`

        Returns
        -------
        (height, width, 3) red, green, blue

        Raises
        ------
        UserError
            As `film`.
        """
        from mjforage.view.render.films import render_frame

        return render_frame(self.recording(policy, world=world, episode=episode), time_s, **how)

    def film(
        self,
        path: Named,
        policy: str | None = None,
        *,
        world: str | None = None,
        episode: int = 0,
        beside: str | None = None,
        **how: Any,
    ) -> Path:
        """Film of an episode: MP4, GIF, or a PNG.

        Parameters
        ----------
        path : its suffix chooses the kind
        policy, world : of the run; by default its first
        beside : another policy, shown beside it
        how : camera ("overview", "chase", "top", "scout"), follow (vessel), seen_by (vessel),
            size (width, height) [pixel], start_s, duration_s, fps, speed

        Raises
        ------
        UserError
            If the run has no such episode, an option does not fit, or there is no OpenGL.
        """
        from mjforage.view.render import render_recording

        which: dict[str, Any] = {"world": world, "episode": episode}
        other = None if beside is None else self.recording(beside, **which)
        render_recording(self.recording(policy, **which), Path(path), beside=other, **how)
        return Path(path)

    def replay(
        self, policy: str | None = None, *, world: str | None = None, episode: int = 0
    ) -> "Player":
        """The web player of an episode, inline in a notebook; raises as `film`."""
        from mjforage.view.report.sections import Page

        shown = self.recording(policy, world=world, episode=episode)
        with tempfile.TemporaryDirectory(prefix="mjforage-") as name:
            folder = Path(name)
            write_bytes(
                recording_file(folder, shown.world, shown.policy, shown.episode), shown.content()
            )
            lead = f"{shown.policy} in world {shown.world}, episode {shown.episode}"
            page = Page(self._info.name, lead, [], self._info.versions.get("mjforage", ""))
            return Player(page.text(folder, {"": replace(self._logs, folder=folder)}))

    def recording(
        self, policy: str | None = None, *, world: str | None = None, episode: int = 0
    ) -> "Recording":
        """Everything visible in an episode, as arrays; played again where it was not recorded.

        Raises
        ------
        UserError
            If the run has no such episode, or it does not come out as it was logged.
        """
        self._check_complete()
        if policy is not None and not isinstance(policy, str):
            raise UserError(f"policy {policy!r}: give its name, one of {', '.join(self.policies)}")
        name = policy or self.policies[0]
        with self._players.known():
            recorded = recording_file(self._folder, world or self.worlds[0], name, episode)
            if name in self.policies and ":" not in name and not recorded.exists():
                self._check_known(name)
            return recording_of_run(self._folder, world, policy, episode)

    def _check_known(self, policy: str) -> None:
        """Refuse to play a policy that was an object of another process and is not given."""
        if not has_policy(policy) and own_weights(policy) is None:
            raise UserError(
                f"policy {policy}: was an object of the process that made this run; give it, as in "
                f'load_run(folder, policies={{"{policy}": ...}})'
            )

    def _table(self, name: str) -> pl.DataFrame:
        folder = RunFolder(self._folder)
        if folder.complete:
            return folder.table(name)
        parts = [
            read_table(path, name)
            for path in sorted(self._folder.glob(f"chunks/[!.]*/{name}.parquet"))
        ]
        if not parts:
            raise UserError(
                "the run was ended before any of its episodes was finished; run it again"
            )
        return pl.concat(parts)

    @cached_property
    def _logs(self) -> "RunLogs":
        from mjforage.view.report.run_logs import load_logs

        self._check_complete()
        return load_logs(self._folder)

    def _check_complete(self) -> None:
        if not self.complete:
            raise UserError(
                "the run is not complete: it was ended early; run evaluate again, with a folder it "
                "goes on where it was"
            )

    @staticmethod
    def _known(kind: str, name: str, known: Any) -> str:
        if name not in known:
            raise UserError(f"{kind} {name!r}: not in this run; {nearest(str(name), list(known))}")
        return name

    def __repr__(self) -> str:
        about = ", ".join((" + ".join(self.worlds), ", ".join(self.policies)))
        partly = "" if self.complete else ", not complete"
        if count := len(self.warnings):
            partly += f", {count} warning{'s' if count != 1 else ''}"
        episodes = f"{self._info.episodes} episode{'s' if self._info.episodes != 1 else ''}"
        return f"Run({self._info.name}, {about}, {episodes}, seed {self.seed}{partly})"

    def _repr_html_(self) -> str:
        from mjforage.view.report.text_tables import headline_table

        if not self.complete:
            return f"<pre>{self!r}</pre>"
        return _html(headline_table(self._logs))


def _html(table: "Table") -> str:
    """A table as HTML, the best of each column in bold."""
    heads = "".join(f"<th>{escape(one)}</th>" for one in (table.head, *table.columns))
    rows = [
        f"<th>{escape(row.head)}</th>"
        + "".join(
            f"<td><b>{escape(cell)}</b></td>" if place in row.best else f"<td>{escape(cell)}</td>"
            for place, cell in enumerate(row.cells)
        )
        for row in table.rows
    ]
    notes = "".join(f"<p><small>{escape(one)}</small></p>" for one in table.notes)
    body = "".join(f"<tr>{row}</tr>" for row in rows)
    return f'<table style="white-space: nowrap"><tr>{heads}</tr>{body}</table>{notes}'


class Player:
    """The web player of one episode: shown inline by a notebook; `str` gives the page."""

    def __init__(self, page: str) -> None:
        self._page = page

    def __str__(self) -> str:
        return self._page

    def _repr_html_(self) -> str:
        how = 'title="Episode" width="100%" height="720" style="border:0" sandbox="allow-scripts"'
        return f'<iframe srcdoc="{escape(self._page)}" {how}></iframe>'
