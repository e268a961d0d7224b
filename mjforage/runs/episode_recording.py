"""One episode, step by step, as plain arrays, for rendering and the report."""

import io
import tokenize
import zipfile
import zlib
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.runs.knowledge_record import AXES as KNOWLEDGE_AXES
from mjforage.runs.knowledge_record import KnowledgeRecord
from mjforage.runs.run_info import AGAIN
from mjforage.scenario.roles import agent_names
from mjforage.scenario.sizes import check_memory

_DAMAGED = (
    *(OSError, ValueError, TypeError, LookupError, EOFError, SyntaxError, RuntimeError),
    *(MemoryError, zipfile.BadZipFile, zlib.error, tokenize.TokenError),
)
"""Errors that zipfile and numpy raise on damaged files."""
_AXES = {
    "navigable": "rc",
    "agent_team": "a",
    "agent_collects": "a",
    "agent_rc": "ta2",
    "agent_target": "ta",
    "item_rc": "ti2",
    "item_present": "ti",
    "belief": "trc",
    "idleness": "trc",
    "in_view": "trc",
    "item_class": "i",
    "track_pose": "fa3",
    "track_items": "fi2",
    "track_present": "fi",
    "track_wind": "f2",
    "t_discovered": "i",
    "quays": "q4",
    **KNOWLEDGE_AXES,
}
"""Axes of the arrays: row, column, agent, item, step (t), frame, or a number."""
_OPTIONAL = "begins_s", "agent_target", "quays"
"""Names that not every file has."""
_FAR_S = 4e10  # from 1970 to a date that is none of a record


@dataclass(frozen=True)
class Recording:
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
    t_discovered: NDArray[np.int16]  # (item,) step of each item's discovery, -1 never
    world: str = "graph"
    policy: str = ""
    seed: int = 0
    episode: int = 0
    knowledge: KnowledgeRecord | None = None
    """Knowledge of each agent; None where all agents know everything."""
    agent_target: NDArray[np.int32] | None = None
    """(T'+1, agent) node that the decision led to, at step 0 the start; None at graph level, where
    agents come to it."""
    begins_s: float | None = None
    """UTC of its start in the record of its weather, since 1970 [s]; None without a record."""
    quays: NDArray[np.float32] | None = None
    """(q, 4) edges of the land's closed outlines, x, y of both ends [m]; None without outlines."""

    @property
    def labels(self) -> tuple[str, ...]:
        """Names (agent,) of the vessels."""
        return agent_names(self.agent_team, self.team_names)

    def content(self) -> bytes:
        """A compressed npz of plain arrays, as the content of a file."""
        buffer = io.BytesIO()
        plain = {k: v for k, v in vars(self).items() if k != "knowledge" and v is not None}
        arrays = {k: np.asarray(value) for k, value in plain.items()}
        arrays |= self.knowledge.arrays() if self.knowledge is not None else {}
        np.savez_compressed(buffer, allow_pickle=False, **arrays)
        return buffer.getvalue()

    @classmethod
    def load(cls, path: Path) -> "Recording":
        """Read a file of such content.

        Raises
        ------
        UserError
            If the file is missing, truncated or not a recording.
        """
        try:
            with zipfile.ZipFile(path) as packed:  # a few bytes can claim any number of them
                unpacked = sum(part.file_size for part in packed.infolist())
            check_memory(f"replay {path}", unpacked, AGAIN)
            with np.load(path, allow_pickle=False) as file:
                return cls(**_values(file))
        except _DAMAGED as error:
            raise UserError(f"replay {path}: cannot be read ({error}); {AGAIN}") from error


def _values(file: Any) -> dict[str, Any]:
    """The fields of a recording from an open npz file."""
    names = [one.name for one in fields(Recording) if one.name != "knowledge"]
    values = {name: file[name] for name in names if name in file or name not in _OPTIONAL}
    _check_axes(values | {name: file[name] for name in KNOWLEDGE_AXES if name in file})
    values["knowledge"] = KnowledgeRecord.of(file, values["navigable"].size)
    for kind, words in (
        (float, ("pitch_m", "period_s", "frame_s", "begins_s")),
        (int, ("horizon", "seed", "episode")),
        (str, ("world", "policy")),
    ):
        values |= {name: kind(values[name]) for name in words if name in values}
    target = values.get("agent_target", np.zeros(0))
    if ((target < 0) | (target >= np.count_nonzero(values["navigable"]))).any():
        raise ValueError("agent_target is no node")
    if abs(values.get("begins_s", 0.0)) > _FAR_S:
        raise ValueError(f"begins_s is {values['begins_s']:g}")
    for name in ("team_names", "vessels"):
        values[name] = tuple(str(word) for word in values[name])
    return values


def _check_axes(values: dict[str, Any]) -> None:
    """Arrays of numbers, whose axes fit together."""
    sizes = {"2": 2, "3": 3, "4": 4}
    for name in [one for one in _AXES if one in values]:
        array, axes = values[name], _AXES[name]
        if array.dtype.kind not in "biuf" or array.ndim != len(axes):
            raise ValueError(f"{name} is {array.dtype} of shape {array.shape}")
        for axis, size in zip(axes, array.shape, strict=True):
            if sizes.setdefault(axis, size) != size:
                raise ValueError(f"{name} of shape {array.shape} does not fit the others")
