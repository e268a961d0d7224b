"""Views of an episode by knowledge: the common one of the fleet, or that of one vessel."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording

EVERYBODY = "all"


def seen_by(recording: Recording, name: str) -> Recording:
    """The episode with belief, idleness and views as a vessel knows them; `all`: as it is.

    Raises `UserError` if there is no such vessel, or no link, so that all know the same.
    """
    names = recording.labels
    if name != EVERYBODY and name not in names:
        choices = ", ".join((EVERYBODY, *names))
        raise UserError(f"seen by {name}: no such vessel; choose {choices}")
    if name == EVERYBODY:
        return recording
    if recording.knowledge is None:
        raise UserError(
            f"seen by {name}: without a link all know the same; choose {EVERYBODY}, or a run with "
            "one (link.model = disk)"
        )
    agent, record = names.index(name), recording.knowledge
    belief, seen = record.maps(agent, recording.navigable.size)
    idleness = np.where(recording.navigable.ravel(), record.idleness(seen), np.float16(0))
    shape, now = recording.belief.shape, np.arange(len(seen), dtype=np.int16)[:, None]
    return replace(
        recording,
        belief=belief.reshape(shape),
        idleness=idleness.reshape(shape),
        in_view=np.where((seen == now).reshape(shape), recording.in_view, np.uint8(0)),
        knowledge=replace(record, viewer=agent),
    )


def shown_name(recording: Recording) -> str:
    """Name of the vessel by whose knowledge a recording is drawn, `all` for the common one."""
    if recording.knowledge is None or recording.knowledge.viewer < 0:
        return EVERYBODY
    return recording.labels[recording.knowledge.viewer]


def last_received(recording: Recording, step: int) -> NDArray[np.int64]:
    """(agent,) step of the newest scan of each that the vessel drawn has received by `step`."""
    record = recording.knowledge
    if record is None or record.viewer < 0:
        return np.full(len(recording.agent_team), step, np.int64)
    newest: NDArray[np.int64] = record.received[step, record.viewer].astype(np.int64)
    return newest


def age_of(recording: Recording, time: float, received: int) -> str:
    """Age at `time` [step] of a scan of step `received`, in words."""
    return f"{(time - received) * recording.period_s + 1e-6:.0f} s"
