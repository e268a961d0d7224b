"""What every finished chunk of episodes took, kept with it: nothing is lost with a killed call."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from mjforage.runs.run_info import field, read_json


@dataclass(frozen=True)
class Invocation:
    """The command that computes, the same for all its chunks."""

    started: str  # ISO 8601 with microseconds, UTC: tells calls apart
    how: str  # processes, local dask cluster, ...
    workers: int  # when it started


@dataclass(frozen=True)
class Cost:
    """What one chunk took, and who played it: one flat record of `costs.json`."""

    world: str
    policy: str
    episodes: int
    steps: int  # decisions, of all episodes
    cpu_s: float  # of the process that played it
    wall_s: float
    began_s: float  # since the epoch, by the worker's clock
    worker: str  # host and process
    started: str  # these three as in `Invocation`
    how: str
    workers: int

    @classmethod
    def of(cls, data: Mapping[str, Any], where: str) -> "Cost":
        """Check a record that was read.

        Raises
        ------
        UserError
            If a key is missing or of another type.
        """
        kinds = {"str": str, "int": int, "float": float}
        names = {one.name: kinds[getattr(one.type, "__name__", "")] for one in fields(cls)}
        return cls(**{name: field(data, name, kind, where) for name, kind in names.items()})


def costs_content(costs: Iterable[Cost]) -> dict[str, Any]:
    """Content of `costs.json`."""
    return {"chunks": [asdict(cost) for cost in costs]}


def load_costs(path: Path) -> tuple[Cost, ...]:
    """Read `costs.json`; nothing where a folder has none.

    Raises
    ------
    UserError
        If it is malformed.
    """
    if not path.is_file():
        return ()
    return tuple(
        Cost.of(one, str(path)) for one in field(read_json(path), "chunks", list, str(path))
    )
