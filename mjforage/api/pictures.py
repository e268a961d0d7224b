"""Episodes of a run to look at: recordings, frames as arrays, films and the web player."""

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from mjforage.api import checks
from mjforage.api.checks import Named
from mjforage.api.inline import Player
from mjforage.api.players import Players
from mjforage.api.progress import bar
from mjforage.base.atomic_files import write_bytes
from mjforage.base.errors import UserError
from mjforage.graph_planner.policies.registry import has_policy, own_weights
from mjforage.runs.replaying import recording_of_run
from mjforage.runs.run_info import load_run
from mjforage.runs.selection import recording_file
from mjforage.runs.storage import RunFolder

if TYPE_CHECKING:
    from mjforage.runs.episode_recording import Recording
    from mjforage.view.report.run_logs import RunLogs

Camera = Literal["overview", "chase", "top", "scout"]
Size = tuple[int | None, int | None]


class Pictures:
    """Recordings, frames and films of the episodes of a run folder."""

    def __init__(self, folder: Named, players: Players) -> None:
        self._folder, self._players = checks.path("folder", folder), players
        self._info = load_run(self._folder / "run.json")

    @property
    def complete(self) -> bool:
        """True if all episodes are finished."""
        return RunFolder(self._folder).complete

    @property
    def policies(self) -> tuple[str, ...]:
        """Policies in their order."""
        return self._info.policies

    @property
    def worlds(self) -> tuple[str, ...]:
        """Worlds in their order."""
        return self._info.worlds

    def frame(
        self,
        policy: str | None = None,
        *,
        world: str | None = None,
        episode: int = 0,
        time_s: float = 0.0,
        camera: Camera | None = None,
        follow: str | None = None,
        seen_by: str = "all",
        size: Size = (None, None),
    ) -> NDArray[np.uint8]:
        """Picture of an episode at a time, drawn offscreen.

        Parameters
        ----------
        policy, world : of the run; by default its first
        time_s : simulated time
        camera, follow, seen_by, size : as of `film`

        Returns
        -------
        (height, width, 3) red, green, blue

        Raises
        ------
        UserError
            As `film`.
        """
        from mjforage.view.render.films import render_frame

        _check_texts(camera=camera, follow=follow, seen_by=seen_by)
        view: dict[str, Any] = {"camera": camera, "follow": follow, "seen_by": seen_by}
        view |= {"size": _checked_size(size)}
        start_s = checks.real("time_s", time_s)
        shown = self.recording(policy, world=world, episode=episode)
        return render_frame(shown, start_s, **view)

    def film(
        self,
        path: Named,
        policy: str | None = None,
        *,
        world: str | None = None,
        episode: int = 0,
        beside: str | None = None,
        camera: Camera | None = None,
        follow: str | None = None,
        seen_by: str = "all",
        size: Size = (None, None),
        start_s: float = 0.0,
        duration_s: float | None = None,
        fps: float = 30.0,
        speed: float | None = None,
        progress: bool | Callable[[int, int], None] | None = None,
    ) -> Path:
        """Film of an episode: MP4, GIF, or PNG, of one frame or a numbered series.

        Parameters
        ----------
        path : FILE.mp4, FILE.gif, FILE.png, or frames-%04d.png for a series
        policy, world : of the run; by default its first
        beside : another policy, shown beside it
        camera : point of view; by default top in the graph world, else overview
        follow : vessel of the cameras chase and scout, such as "foragers_1"
        seen_by : vessel by whose knowledge the episode is drawn, or "all"
        size : (width, height) [pixel], by default 1280 x 720; one alone gives the other, 16:9
        start_s, duration_s : what to show [simulated s]; by default the whole episode
        fps : frames per second of the film
        speed : simulated seconds per second of film; by default four decisions, for chase and
            scout one
        progress : as of `evaluate`, counted in frames

        Raises
        ------
        UserError
            If the run has no such episode, an option does not fit, or there is no OpenGL.
        """
        from mjforage.view.render import render_recording

        target, fps = checks.path("path", path), checks.real("fps", fps)
        _check_texts(camera=camera, follow=follow, seen_by=seen_by, beside=beside)
        view: dict[str, Any] = {"camera": camera, "follow": follow, "seen_by": seen_by}
        view |= {"size": _checked_size(size), "fps": fps}
        view["start_s"] = checks.real("start_s", start_s)
        for name, value in (("duration_s", duration_s), ("speed", speed)):
            view[name] = None if value is None else checks.real(name, value)
        which: dict[str, Any] = {"world": world, "episode": episode}
        shown = self.recording(policy, **which)
        other = None if beside is None else self.recording(beside, **which)
        with bar("film", "frames", progress) as done:
            render_recording(shown, target, beside=other, progress=done, **view)
        return target

    def replay(
        self, policy: str | None = None, *, world: str | None = None, episode: int = 0
    ) -> Player:
        """The web player of an episode, inline in a notebook; raises as `film`."""
        from mjforage.view.report.sections import Page

        shown = self.recording(policy, world=world, episode=episode)
        with tempfile.TemporaryDirectory(prefix="mjforage-") as name:
            folder = Path(name)
            file = recording_file(folder, shown.world, shown.policy, shown.episode)
            write_bytes(file, shown.content())
            lead = f"{shown.policy} in world {shown.world}, episode {shown.episode}"
            page = Page(self._info.name, lead, [], self._info.versions.get("mjforage", ""))
            text = page.text(folder, replace(self._logs, folder=folder))
        return Player(text, lead)

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
        name = self.policies[0] if policy is None else checks.text("policy", policy)
        where = self.worlds[0] if world is None else checks.text("world", world)
        number = checks.whole("episode", episode, 0, self._info.episodes - 1)
        with self._players.known():
            recorded = recording_file(self._folder, where, name, number)
            if name in self.policies and ":" not in name and not recorded.exists():
                self._check_known(name)
            return recording_of_run(self._folder, where, name, number)

    def _check_known(self, policy: str) -> None:
        """Refuse to play a policy that was an object of another process and is not given."""
        if not has_policy(policy) and own_weights(policy) is None:
            raise UserError(
                f"policy {policy}: was an object of the process that made this run; give it, as in "
                f'load_run(folder, policies={{"{policy}": ...}})'
            )

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


def _check_texts(**named: object) -> None:
    """Refuse what is neither a text nor absent; raises `TypeError`."""
    for name, value in named.items():
        if value is not None:
            checks.text(name, value)


def _checked_size(size: object) -> Size:
    """Width and height of a frame; raises `TypeError` for anything else."""
    if not isinstance(size, Sequence) or isinstance(size, str) or len(size) != 2:
        raise TypeError(f"size is {size!r}; give (width, height) in pixels")
    width, height = (None if one is None else checks.whole("size", one, 1) for one in size)
    return width, height
