"""Processor and clock time of every finished chunk of episodes, stored in the chunk's folder."""

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

from mjforage.base.fields import Note
from mjforage.runs.run_info import REMEDY, read_json
from mjforage.scenario.schema import OPEN, check


@dataclass(frozen=True)
class Invocation:
    """The command that computes, the same for all its chunks."""

    started: str  # ISO 8601 with microseconds, UTC: tells calls apart
    how: str  # processes, or dask at an address
    workers: int  # when it started


@dataclass(frozen=True)
class Cost:
    """Computing time of one chunk, and its worker: one flat record of `costs.json`."""

    __pydantic_config__ = OPEN

    world: str
    """World of the chunk."""
    policy: str
    """Policy of the chunk."""
    episodes: int
    """Episodes of the chunk."""
    steps: int
    """Decisions of all its episodes."""
    cpu_s: Annotated[float, Note("unit", "s")]
    """Processor time of the process that played it."""
    wall_s: Annotated[float, Note("unit", "s")]
    """Time from its beginning to its end."""
    began_s: Annotated[float, Note("unit", "s")]
    """Time of its beginning, since the epoch, by the worker's clock."""
    worker: str
    """Host and process that played it."""
    started: str
    """Time of the command, ISO 8601 with microseconds."""
    how: str
    """Kind of workers: processes, or dask at an address"""
    workers: int
    """Workers when the command was given."""
    decide_s: Annotated[float, Note("unit", "s")] = 0.0
    """Part of `cpu_s` for the policy's decisions, without its first call; 0 if not measured."""
    decisions: int = 0
    """Decisions for the whole fleet made in `decide_s`."""

    @classmethod
    def of(cls, data: object, where: str) -> "Cost":
        """Check a record that was read.

        Raises `UserError` if a key is missing or of another type.
        """
        return check(cls, data, where, remedy=REMEDY)


@dataclass(frozen=True)
class Costs:
    """Content of `costs.json`."""

    __pydantic_config__ = OPEN

    chunks: tuple[Cost, ...]
    """A record of every chunk, in the order of the tables."""


def costs_content(costs: Iterable[Cost]) -> dict[str, Any]:
    """Content of `costs.json`."""
    return {"chunks": [asdict(cost) for cost in costs]}


def load_costs(path: Path) -> tuple[Cost, ...]:
    """Read `costs.json`; nothing where a folder has none.

    Raises `UserError` if it is malformed.
    """
    if not path.is_file():
        return ()
    return check(Costs, read_json(path), str(path), remedy=REMEDY).chunks
