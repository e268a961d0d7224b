"""Run folders: identity of a run, its finished chunks, and the tables merged from them.

A chunk is a folder of four Parquet files that appears whole or not at all (written beside, then
renamed), so a killed run resumes where it stopped. `run.json` is written first, `summary.json`
last; a folder with both and all tables is complete. Nothing that is not of the run is overwritten
or removed.
"""

import contextlib
import json
import shutil
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import polars as pl

from mjforage.base.atomic_files import remove_parts, write_errors
from mjforage.base.errors import UserError
from mjforage.base.references import file_label
from mjforage.runs.costs import Cost
from mjforage.runs.lock import folder_lock
from mjforage.runs.parquet import join_parquet, parquet_bytes, spoilt
from mjforage.runs.resuming import CODE, found_in, open_folder
from mjforage.runs.run_info import AGAIN, read_json
from mjforage.runs.tables import KEYS, TABLES, check_table, read_table

IDENTITY = (
    "scenario",
    "map",
    "seed",
    "episodes",
    "worlds",
    "policies",
    "weights",
    "agents",
    "hulls",
    "metrics",
    *CODE,
)


@dataclass(frozen=True, order=True)
class Chunk:
    """A unit of work: some consecutive episodes of one policy in one world."""

    world: str
    policy: str
    first: int
    count: int

    @property
    def name(self) -> str:
        """Folder name of the finished chunk."""
        return f"{self.world}-{file_label(self.policy)}-{self.first:06d}-{self.count}"

    @property
    def keys(self) -> list[tuple[str, str, int]]:
        """World, policy and episode of its rows."""
        episodes = range(self.first, self.first + self.count)
        return [(self.world, self.policy, episode) for episode in episodes]


class RunFolder:
    """The folder of one run."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._chunks = path / "chunks"

    def check(self, info: Mapping[str, Any], accept: bool = False) -> None:
        """Check as `open` does, and write nothing."""
        found_in(self.path, "run", info, IDENTITY, accept)

    def open(self, info: Mapping[str, Any], accept: bool = False) -> dict[str, Any]:
        """Create the folder for a run, or check that it holds the same one.

        Raises `UserError` if the folder holds another run (the difference is named) or something
        else, or cannot be written.

        Returns: the content that `run.json` is to have.

        Parameters
        ----------
        info : content of `run.json`
        accept : go on although code or versions differ, see `open_folder`
        """
        info = open_folder(self.path, "run", info, IDENTITY, accept)
        for table in TABLES:
            if (self.path / f"{table}.parquet").exists():
                path = self.path / f"{table}.parquet"
                check_table(path, table, spoilt(path, AGAIN))
        return info

    def lock(self) -> contextlib.AbstractContextManager[None]:
        """Keep other processes from writing the folder, as `folder_lock`."""
        return folder_lock(self.path)

    @property
    def complete(self) -> bool:
        """True if the run is finished and all its files are there."""
        names = ("run.json", "summary.json", *(f"{table}.parquet" for table in TABLES))
        return all((self.path / name).is_file() for name in names)

    def finished(self, name: str) -> pl.DataFrame | None:
        """A table's rows of all finished chunks; None if there are none.

        Raises `UserError` if a file is truncated or foreign.
        """
        if self.complete:
            return self.table(name)
        files = sorted(self._chunks.glob(f"[!.]*/{name}.parquet"))
        return pl.concat(read_table(file, name) for file in files) if files else None

    def has(self, chunk: Chunk) -> bool:
        """True if a chunk is finished.

        Raises `UserError` if its files are truncated or foreign, or hold other episodes.
        """
        folder = self._chunks / chunk.name
        if not folder.is_dir():
            return False
        for table in TABLES:
            path = folder / f"{table}.parquet"
            remedy = spoilt(folder, AGAIN)
            _check_keys(path, read_table(path, table, remedy), chunk.keys, remedy)
        self.costs([chunk])
        return True

    def has_folder(self, chunk: Chunk) -> bool:
        """True if a chunk's folder is there, whatever it holds."""
        return (self._chunks / chunk.name).is_dir()

    def stored(self, worlds: Iterable[str], policies: Iterable[str]) -> list[Chunk]:
        """All chunks of these worlds and policies that are there, whatever they hold."""
        names = list(policies)
        known = {f"{one}-{file_label(name)}": (one, name) for one in worlds for name in names}
        found = (path.name.rsplit("-", 2) for path in self._chunks.glob("[!.]*-*-*"))
        return [
            Chunk(*known[label], int(first), int(count))
            for label, first, count in found
            if label in known and first.isdecimal() and count.isdecimal()
        ]

    def write(self, chunk: Chunk, frames: Mapping[str, pl.DataFrame], cost: Cost) -> None:
        """Store a finished chunk, whole or not at all.

        Raises `UserError` if it cannot be written.
        """
        target = self._chunks / chunk.name
        with write_errors(target):
            self._chunks.mkdir(exist_ok=True)
            temporary = Path(tempfile.mkdtemp(prefix=".", dir=self._chunks))
            try:
                for name, frame in frames.items():
                    (temporary / f"{name}.parquet").write_bytes(parquet_bytes(frame))
                (temporary / "cost.json").write_text(json.dumps(asdict(cost)), "utf-8")
                temporary.rename(target)
            except OSError:
                # A dying worker of a killed run may have finished the same chunk: it is equal.
                if not self.has(chunk):
                    raise
            finally:
                shutil.rmtree(temporary, ignore_errors=True)

    def costs(self, chunks: list[Chunk]) -> list[Cost]:
        """Computing time of each of the chunks.

        Raises `UserError` if that is missing or malformed.
        """
        found = []
        for chunk in chunks:
            folder = self._chunks / chunk.name
            file = folder / "cost.json"
            try:
                found.append(Cost.of(read_json(file), str(file)))
            except UserError as error:
                raise UserError(
                    f"{file}: missing or not written by mjforage; delete {folder} and {AGAIN}"
                ) from error
        return found

    def merge(self, chunks: list[Chunk]) -> None:
        """Join the chunks' tables in order and write them beside `run.json`.

        Raises `UserError` if a table cannot be written.
        """
        for table in TABLES:
            sources = [self._chunks / chunk.name / f"{table}.parquet" for chunk in chunks]
            join_parquet(sources, self.path / f"{table}.parquet")

    def finish(self, chunks: Iterable[Chunk]) -> None:
        """Remove the chunks of a complete run, and partial files of killed ones.

        Everything that chunks hold is in the merged tables.
        """
        for name in (*(f"{table}.parquet" for table in TABLES), "run.json", "summary.json"):
            remove_parts(self.path / name)
        for folder in (*(self._chunks / chunk.name for chunk in chunks), *self._chunks.glob(".*")):
            shutil.rmtree(folder, ignore_errors=True)
        with contextlib.suppress(OSError):  # something else is in it, and stays
            self._chunks.rmdir()

    def table(self, name: str) -> pl.DataFrame:
        """A merged table; raises `UserError` if it is missing, truncated or foreign."""
        path = self.path / f"{name}.parquet"
        return read_table(path, name, spoilt(path, AGAIN) if path.exists() else AGAIN)

    def episodes(self, chunks: list[Chunk]) -> pl.DataFrame:
        """The merged table of episodes.

        Raises `UserError` if it is missing, truncated or foreign, or does not hold the episodes of
        the chunks.
        """
        path, table = self.path / "episodes.parquet", self.table("episodes")
        keys = [key for chunk in chunks for key in chunk.keys]
        _check_keys(path, table, keys, spoilt(path, AGAIN))
        return table


def _check_keys(
    path: Path, frame: pl.DataFrame, keys: list[tuple[str, str, int]], remedy: str
) -> None:
    found = set(frame.select(*KEYS).unique().rows())
    if found != set(keys):
        raise UserError(f"{path}: does not hold the {len(keys)} episodes that it should; {remedy}")
