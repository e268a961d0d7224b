"""A run: its tables as polars frames, differences, figures and reports."""

import shutil
import weakref
from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import polars as pl

from mjforage.api import checks
from mjforage.api.checks import Named
from mjforage.api.differences import differences_of, needed_of
from mjforage.api.inline import table_html
from mjforage.api.pictures import Pictures
from mjforage.api.players import Players
from mjforage.api.scenarios import Scenario
from mjforage.base.atomic_files import write_errors
from mjforage.base.errors import UserError
from mjforage.runs.evaluate import summarise
from mjforage.runs.storage import RunFolder
from mjforage.scenario.scenario_file import scenario_from_tree

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NOBODY = Players()


class Run(Pictures):
    """Policies on the same episodes, in one world or several; made by `evaluate` and `load_run`.

    Tables are copies: what is done to them changes no run.

    Examples
    --------
    >>> import mjforage as mf
    >>> run = mf.evaluate("open-bay", "greedy", episodes=2, horizon=20)
    >>> run
    Run(open-bay, graph, greedy, 2 episodes, seed 0)
    >>> run.summary.filter(metric="pta_c").columns
    ['world', 'policy', 'metric', 'mean', 'low', 'high', 'sem', 'iqm', 'worst5', 'n']
    """

    def __init__(
        self,
        folder: Named,
        temporary: Path | None = None,
        players: Players = NOBODY,
        warnings: Sequence[str] = (),
    ) -> None:
        """Open a run folder; a temporary one around it goes when the run does."""
        super().__init__(folder, players)
        self._warnings = tuple(warnings)
        self._in_memory = temporary is not None
        if temporary is not None:
            weakref.finalize(self, shutil.rmtree, temporary, ignore_errors=True)

    @property
    def folder(self) -> Path | None:
        """The run folder; None where the run is in memory alone."""
        return None if self._in_memory else self._folder

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of the call that made the run, each a line; none of a run that was loaded."""
        return self._warnings

    @property
    def seed(self) -> int:
        """Seed of the run."""
        return self._info.seed

    @cached_property
    def scenario(self) -> Scenario:
        """Scenario and map that were played."""
        where = str(self._folder / "run.json")
        scenario = scenario_from_tree(dict(self._info.scenario), where)
        return Scenario(scenario, self._info.map.grid)

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
        """A row per world, policy and metric: mean, 95 % interval (low, high), standard error,
        interquartile mean, mean of the worst 5 % (worst5), and episodes where it is defined (n).
        """
        info = self._info
        rows = [
            {"world": world, "policy": policy, "metric": metric, "mean": one["mean"]}
            | {"low": one["ci95"][0], "high": one["ci95"][1]}
            | {key: one[key] for key in ("sem", "iqm", "worst5", "n")}
            for world, policies in summarise(self.episodes, info.metrics, info.horizon).items()
            for policy, metrics in policies.items()
            for metric, one in metrics.items()
        ]
        return pl.DataFrame(rows, infer_schema_length=None)

    @property
    def clearing(self) -> pl.DataFrame:
        """A row per world, policy and share (.5, .9, .99) of the items of an episode: median time
        until it is collected [min], infinite if never, with its 95 % interval (low, high); share
        of the n episodes that never get there, with its interval.
        """
        from mjforage.view.report.clearing import clearing_frame

        return clearing_frame(self._logs)

    def differences(
        self,
        policy: str | None = None,
        against: str | None = None,
        *,
        world: str | tuple[str, str] | None = None,
        metrics: str | Sequence[str] = (),
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
        world, policy, metric, difference, its 95 % interval (low, high) and p, both of all rows
        together (`metrics.compared`), n episodes; neither of fewer than 10

        Raises
        ------
        UserError
            If there is no such policy, world or metric, or the run is not complete.
        """
        return differences_of(self._logs, policy, against, world, metrics)

    def episodes_needed(self, difference: float, metric: str = "pta_c") -> pl.DataFrame:
        """Episodes with which a difference of this size would be found, from the run's own spread.

        Found means told from 0 by a paired test at the level 0.05, in 80 % of the runs.

        Parameters
        ----------
        difference : in the unit of the metric, above 0
        metric : key

        Returns
        -------
        world, policy, metric, sd of the paired differences, episodes (of each; null with fewer
        than 10 here), a row for each two policies of a world and each policy in two worlds

        Raises
        ------
        UserError
            If there is no such metric, the difference is not above 0, there is one policy in one
            world, or the run is not complete.
        """
        return needed_of(self._logs, difference, metric)

    def plot(self, what: str = "progress") -> "Figure":
        """Draw a figure of the report: "progress", "gap", "tracks", or the name of another.

        Raises
        ------
        UserError
            If there is no such figure; the message names all.
        """
        from mjforage.view.report.report_page import draw_figures

        checks.text("figure", what)
        found = {one.name: one.figure for one in draw_figures(self._logs)}
        named = {"progress": "pta"}.get(what, what)
        return found[checks.one_of("figure", named, found)]

    def report(
        self,
        path: Named | None = None,
        *,
        policies: str | Sequence[str] = (),
        tables: str | Sequence[str] = (),
        figures: str | Sequence[str] = (),
    ) -> Path:
        """Write `report.html` with its tables and figures into the run folder, or a page alone.

        Parameters
        ----------
        path : file of the page; None: `report.html` of the run folder
        policies : those to show; by default all, or of more than 20 the best
        tables : formats of tables in the run folder, besides csv: latex, markdown
        figures : formats of figures in the run folder: pdf, png, svg

        Raises
        ------
        UserError
            If the run is not complete, or a file cannot be written.
        """
        from mjforage.view.report import Exports, write_report

        self._check_complete()
        target = None if path is None else checks.path("path", path)
        if target is None and self._in_memory:
            raise UserError('report: the run has no folder; give a path, as in "report.html"')
        if target is not None and target.is_dir():
            raise UserError(f"report {target}: is a folder; give the name of a file")
        exports = Exports.of(checks.texts("tables", tables), checks.texts("figures", figures))
        page = write_report(self._folder, exports, checks.texts("policies", policies))
        if target is None:
            return page
        with write_errors(target):
            return Path(shutil.copyfile(page, target))

    def save(self, folder: Named) -> Path:
        """Copy the run into a folder that is not there yet, as the command line writes it.

        Raises
        ------
        UserError
            If there is something of that name.
        """
        target = checks.path("folder", folder)
        if target.exists():
            raise UserError(f"folder {target}: is there already; name another")
        with write_errors(target):
            return Path(shutil.copytree(self._folder, target))

    def export(
        self,
        folder: Named,
        to: str,
        *,
        policy: str | None = None,
        world: str | None = None,
        episode: int = 0,
    ) -> Path:
        """Write an episode in a format of other programs.

        Parameters
        ----------
        folder, to : as of `Scenario.export`, with the whole episode
        policy, world : of the run; by default its first

        Raises
        ------
        UserError
            As `Scenario.export`, and as `film` if the run has no such episode.
        """
        from mjforage.runs.exporting import write_export

        where = checks.path("folder", folder), checks.text("to", to)
        which: dict[str, Any] = {"world": world, "episode": episode}
        return write_export(self.scenario, lambda: self.recording(policy, **which), *where)

    def stream(
        self,
        *,
        policy: str | None = None,
        world: str | None = None,
        episode: int = 0,
        port: int = 8765,
        speed: float = 10.0,
        ready: Callable[[str], None] = print,
    ) -> None:
        """Serve an episode live to a viewer on this machine, such as Foxglove.

        It begins when a viewer has subscribed to a topic, and returns after the last message.

        Parameters
        ----------
        policy, world, episode : as of `export`
        port : of this machine; 0 for any that is free
        speed : simulated seconds per second
        ready : called with the address, such as ``ws://127.0.0.1:8765``

        Raises
        ------
        UserError
            As `film` if the run has no such episode; if the port is taken.
        """
        from mjforage.runs.exporting.live import stream

        at = checks.whole("port", port, 0, 65535), checks.real("speed", speed, 0)
        checks.function("ready", ready)
        shown = self.recording(policy, world=world, episode=episode)
        stream(self.scenario, shown, *at, ready)

    def _table(self, name: str) -> pl.DataFrame:
        if not (self._folder / "run.json").is_file():
            raise UserError(f"{self._folder}: the run folder is gone; load or make the run again")
        found = RunFolder(self._folder).finished(name)
        if found is None:
            raise UserError(
                "the run was ended before any of its episodes was finished; run it again"
            )
        return found

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
        return table_html(headline_table(self._logs))

    def __copy__(self) -> "Run":
        return self  # nothing changes it

    def __deepcopy__(self, memo: object) -> "Run":
        return self

    def __reduce__(self) -> Any:
        raise TypeError("a Run is not pickled; give its folder and open that with load_run")
