"""Events of a recording: discoveries and collections, and the percentages that follow."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording

NEVER = np.iinfo(np.int64).max


@dataclass(frozen=True)
class Timeline:
    """Events of one episode of T' steps."""

    length: int  # T' [step]
    discovered: NDArray[np.int64]  # (item,) step, NEVER if not
    known: NDArray[np.int64]  # (item,) the same for those by whose knowledge the episode is drawn
    removed: NDArray[np.int64]  # (item,) step, NEVER if not
    pta_d: NDArray[np.float64]  # (T'+1,) [%]
    pta_c: NDArray[np.float64]  # (T'+1,) [%]

    @classmethod
    def of(cls, recording: Recording) -> "Timeline":
        """Events of a recording; discoveries are as they were logged."""
        steps, items = recording.item_present.shape
        gone, record = ~recording.item_present, recording.knowledge
        removed = np.where(gone.any(axis=0), gone.argmax(axis=0), NEVER)
        discovered = known = _or_never(recording.t_discovered)
        if record is not None and record.viewer >= 0:
            known = _or_never(record.known_from[record.viewer])
        step, share = np.arange(steps)[:, None], 100.0 / max(items, 1)
        pta_d, pta_c = (share * (one <= step).sum(axis=1) for one in (discovered, removed))
        return cls(steps - 1, discovered, known, removed, pta_d, pta_c)


def _or_never(step: NDArray[np.int16]) -> NDArray[np.int64]:
    """Steps with NEVER for those below 0."""
    return np.where(step < 0, NEVER, step.astype(np.int64))
