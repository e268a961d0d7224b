"""One episode, step by step, as plain arrays: what rendering and the report draw from."""

import io
import zipfile
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mjforage.core.errors import UserError
from mjforage.runs.run_info import again


@dataclass(frozen=True)
class Replay:
    """Everything visible in one episode. T' is its length; step 0 is the state before any move.

    What decisions see is kept per step; where bodies are, per frame of a track, several to a step
    in the physics world, one to a step at graph level.

    Positions are (row, column) in node units, row growing southwards; node centres are integers.
    """

    navigable: NDArray[np.bool_]  # (row, column)
    pitch_m: float
    horizon: int
    period_s: float
    team_names: tuple[str, ...]
    agent_team: NDArray[np.int64]  # (agent,) index into team_names
    agent_collects: NDArray[np.bool_]  # (agent,) True for foragers
    agent_rc: NDArray[np.float32]  # (T'+1, agent, 2) [node]
    item_rc: NDArray[np.float32]  # (T'+1, item, 2) [node]; last position once removed
    item_present: NDArray[np.bool_]  # (T'+1, item) False once removed
    belief: NDArray[np.int16]  # (T'+1, row, column) believed items per node
    idleness: NDArray[np.float16]  # (T'+1, row, column) in [0, 1]; 0 on land
    in_view: NDArray[np.uint8]  # (T'+1, row, column) bit 0: a scout sees it, bit 1: a forager
    vessels: tuple[str, ...]  # (agent,) parameter set of each hull
    item_class: NDArray[np.int16]  # (item,) index into the debris classes that ship
    frame_s: float  # time between frames of the track; frame 0 is t = 0 [s]
    track_pose: NDArray[np.float32]  # (F, agent, 3) x, y [m], yaw [rad], ENU
    track_items: NDArray[np.float32]  # (F, item, 2) x, y [m]; last position once removed
    track_present: NDArray[np.bool_]  # (F, item) False once removed
    track_wind: NDArray[np.float32]  # (F, 2) wind over ground, without place [m/s]
    world: str = "graph"
    policy: str = ""
    seed: int = 0
    episode: int = 0
    t_discovered: NDArray[np.int16] | None = None
    """(item,) step of each item's discovery, -1 never; None in files of versions without it."""

    def content(self) -> bytes:
        """A compressed npz of plain arrays, as the content of a file."""
        buffer = io.BytesIO()
        arrays = {k: np.asarray(value) for k, value in vars(self).items() if value is not None}
        np.savez_compressed(buffer, allow_pickle=False, **arrays)
        return buffer.getvalue()

    @classmethod
    def load(cls, path: Path) -> "Replay":
        """Read a file of such content.

        Raises
        ------
        UserError
            If the file is missing, truncated or not a replay.
        """
        if path.is_file() and not zipfile.is_zipfile(path):
            raise UserError(
                f"replay {path}: truncated or not a replay; {again(path.parent.parent)}"
            )
        try:
            with np.load(path, allow_pickle=False) as file:
                names = [f.name for f in fields(cls) if f.name != "t_discovered" or f.name in file]
                values = {name: file[name] for name in names}
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
            raise UserError(
                f"replay {path}: cannot be read ({error}); {again(path.parent.parent)}"
            ) from error
        for name in ("pitch_m", "period_s", "frame_s"):
            values[name] = float(values[name])
        for name in ("horizon", "seed", "episode"):
            values[name] = int(values[name])
        for name in ("world", "policy"):
            values[name] = str(values[name])
        for name in ("team_names", "vessels"):
            values[name] = tuple(str(word) for word in values[name])
        return cls(**values)
