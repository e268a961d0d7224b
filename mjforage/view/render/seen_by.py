"""By whose knowledge an episode is drawn: what all know together, or one vessel alone."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording

EVERYBODY = "all"


def seen_by(replay: Recording, name: str) -> Recording:
    """The episode with belief, idleness and views as a vessel knows them; `all`: as it is.

    Raises
    ------
    UserError
        If there is no such vessel, or no link, so that all know the same.
    """
    names = replay.labels
    if name != EVERYBODY and name not in names:
        choices = ", ".join((EVERYBODY, *names))
        raise UserError(f"seen by {name}: no such vessel; choose {choices}")
    if name == EVERYBODY:
        return replay
    if replay.held is None:
        raise UserError(
            f"seen by {name}: without a link all know the same; choose {EVERYBODY}, or a run with "
            "one (--set link.model=disk)"
        )
    agent, held = names.index(name), replay.held
    belief, seen = held.maps(agent, replay.navigable.size)
    idleness = np.where(replay.navigable.ravel(), held.idleness(seen), np.float16(0))
    shape, now = replay.belief.shape, np.arange(len(seen), dtype=np.int16)[:, None]
    return replace(
        replay,
        belief=belief.reshape(shape),
        idleness=idleness.reshape(shape),
        in_view=np.where((seen == now).reshape(shape), replay.in_view, np.uint8(0)),
        held=replace(held, shown=agent),
    )


def shown_name(replay: Recording) -> str:
    """Name of the vessel by whose knowledge a replay is drawn, `all` if by everybody's."""
    if replay.held is None or replay.held.shown < 0:
        return EVERYBODY
    return replay.labels[replay.held.shown]


def last_heard(replay: Recording, step: int) -> NDArray[np.int64]:
    """(agent,) step of the newest look of each that is known by `step` to whom is drawn."""
    if replay.held is None or replay.held.shown < 0:
        return np.full(len(replay.agent_team), step, np.int64)
    heard: NDArray[np.int64] = replay.held.heard[step, replay.held.shown].astype(np.int64)
    return heard


def age_of(replay: Recording, time: float, heard: int) -> str:
    """How long ago a look of step `heard` was at `time` [step], in words."""
    return f"{(time - heard) * replay.period_s + 1e-6:.0f} s"
