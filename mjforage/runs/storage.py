"""Run folders: what identifies a run, its finished chunks, and the tables merged from them.

A chunk is a folder of four Parquet files that appears whole or not at all (written beside, then
renamed), so a killed run resumes where it stopped. `run.json` is written first, `summary.json`
last; a folder with both and all tables is complete. Nothing that is not of the run is overwritten
or removed.
"""

import contextlib
import io
import json
import logging
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import polars as pl

from graph_planner.references import file_label
from mjforage.core.errors import UserError
from mjforage.runs.costs import Cost
from mjforage.runs.resuming import CODE, acceptable, differences, refusal, with_accepted
from mjforage.runs.run_info import again, read_json
from mjforage.runs.tables import KEYS, TABLES, check_table, read_table

try:
    import fcntl
except ImportError:  # not on this system: runs are then not kept apart
    fcntl = None  # type: ignore[assignment]

_logger = logging.getLogger(__name__)

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


@contextlib.contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn a failure to write into one clear error.

    Raises
    ------
    UserError
        If the disk is full, the folder is read-only, or anything else keeps a file from being
        written.
    """
    try:
        yield
    except (FileExistsError, NotADirectoryError) as error:
        raise UserError(
            f"{path}: cannot be written (a file is there, or where a folder above it should be); "
            "choose another --out"
        ) from error
    except (OSError, pl.exceptions.PolarsError) as error:
        reason = getattr(error, "strerror", None) or str(error).splitlines()[0]
        raise UserError(
            f"{path}: cannot be written ({reason}); free some space or choose another --out, then "
            "run the same command again: finished chunks are kept"
        ) from error


def write_json(path: Path, value: object) -> None:
    """Write JSON through a temporary file, so that the file is whole or absent; leave an equal one.

    Raises
    ------
    UserError
        If it cannot be written.
    """
    text = json.dumps(value, indent=1, allow_nan=False) + "\n"
    with writing(path):
        if path.is_file() and path.read_bytes() == text.encode():
            return
        temporary = path.with_name(f".{path.name}.{os.getpid()}")
        try:
            temporary.write_text(text, "utf-8")
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)


@contextlib.contextmanager
def claimed(path: Path) -> Iterator[None]:
    """Keep other processes from writing a folder; the system lets go of it with the process.

    Raises
    ------
    UserError
        If another process is writing it.
    """
    if fcntl is None:
        yield
        return
    folder = os.open(path, os.O_RDONLY)
    try:
        fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError as error:
        raise UserError(
            f"{path}: another process is writing this run; wait for it, or choose another --out"
        ) from error
    finally:
        os.close(folder)


def open_folder(
    path: Path, kind: str, info: Mapping[str, Any], identity: Iterable[str], accept: bool = False
) -> dict[str, Any]:
    """Create a folder whose file `<kind>.json` says what it holds, or check that it says the same.

    Parameters
    ----------
    path : the folder
    kind : run, study or training
    info : content of the file
    identity : its keys that must be the same
    accept : go on although code or versions differ; the file then says so

    Returns
    -------
    The content that the file is to have, changes accepted so far included.

    Raises
    ------
    UserError
        If the folder holds another one (the difference is named) or something else, or cannot be
        written.
    """
    file = path / f"{kind}.json"
    with writing(path):
        path.mkdir(parents=True, exist_ok=True)
        found = sorted(entry.name for entry in path.iterdir() if entry.name[0] != ".")
    if file.name not in found:
        if found:
            raise UserError(
                f"{path}: holds {found[0]} but no {file.name}, so it is no {kind} folder; choose "
                "another --out"
            )
        write_json(file, info)
        return dict(info)
    try:
        there = read_json(file)
    except UserError as error:
        raise UserError(
            f"{file}: is not the {file.name} of a {kind}; choose another --out"
        ) from error
    differing = differences(there, info, identity)
    if differing and not (accept and acceptable(differing)):
        raise UserError(f"{path}: {refusal(kind, differing)}")
    content = with_accepted(there, info, differing)
    if differing:
        changed = {key: content[key] for key in (*CODE, "hash", "accepted") if key in content}
        write_json(file, there | changed)
    return content


def set_aside(path: Path, kind: str) -> Path | None:
    """Rename a folder that holds a run, study or training, so that its place is free.

    Returns
    -------
    Its new name; None if there was none

    Raises
    ------
    UserError
        If another process is writing it, or it cannot be renamed.
    """
    if not (path / f"{kind}.json").is_file():
        return None
    now = f"{datetime.now(UTC):%Y%m%dT%H%M%S}"
    names = (f"{path.name}.before-{now}{more}" for more in ("", *(f"-{n}" for n in range(2, 100))))
    with claimed(path), writing(path):
        aside = next(path.parent / name for name in names if not (path.parent / name).exists())
        path.rename(aside)
    _logger.warning("%s: what it held is kept as %s", path, aside)
    return aside


class RunFolder:
    """The folder of one run."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._chunks = path / "chunks"

    def open(self, info: Mapping[str, Any], accept: bool = False) -> dict[str, Any]:
        """Create the folder for a run, or check that it holds the same one.

        Parameters
        ----------
        info : content of `run.json`
        accept : go on although code or versions differ, see `open_folder`

        Returns
        -------
        The content that `run.json` is to have.

        Raises
        ------
        UserError
            If the folder holds another run (the difference is named) or something else, or cannot
            be written.
        """
        info = open_folder(self.path, "run", info, IDENTITY, accept)
        for table in TABLES:
            if (self.path / f"{table}.parquet").exists():
                path = self.path / f"{table}.parquet"
                check_table(path, table, self._moved(path))
        return info

    def claimed(self) -> contextlib.AbstractContextManager[None]:
        """Keep other processes from writing the folder, as `claimed`."""
        return claimed(self.path)

    @property
    def complete(self) -> bool:
        """Whether the run is finished and all its files are there."""
        names = ("run.json", "summary.json", *(f"{table}.parquet" for table in TABLES))
        return all((self.path / name).is_file() for name in names)

    def has(self, chunk: Chunk) -> bool:
        """Whether a chunk is finished.

        Raises
        ------
        UserError
            If its files are truncated or foreign, or hold other episodes.
        """
        folder = self._chunks / chunk.name
        if not folder.is_dir():
            return False
        for table in TABLES:
            path = folder / f"{table}.parquet"
            remedy = self._moved(folder)
            _check_keys(path, read_table(path, table, remedy), chunk.keys, remedy)
        self.costs([chunk])
        return True

    def write(self, chunk: Chunk, frames: Mapping[str, pl.DataFrame], cost: Cost) -> None:
        """Store a finished chunk, whole or not at all.

        Raises
        ------
        UserError
            If it cannot be written.
        """
        target = self._chunks / chunk.name
        with writing(target):
            self._chunks.mkdir(exist_ok=True)
            temporary = Path(tempfile.mkdtemp(prefix=".", dir=self._chunks))
            try:
                for name, frame in frames.items():
                    buffer = io.BytesIO()  # a full disk is then told in words, by Python
                    frame.write_parquet(buffer, compression="zstd")
                    (temporary / f"{name}.parquet").write_bytes(buffer.getvalue())
                (temporary / "cost.json").write_text(json.dumps(asdict(cost)), "utf-8")
                temporary.rename(target)
            except OSError:
                # A dying worker of a killed run may have finished the same chunk: it is equal.
                if not self.has(chunk):
                    raise
            finally:
                shutil.rmtree(temporary, ignore_errors=True)

    def costs(self, chunks: list[Chunk]) -> list[Cost]:
        """What each of the chunks took.

        Raises
        ------
        UserError
            If that is missing or malformed.
        """
        found = []
        for chunk in chunks:
            folder = self._chunks / chunk.name
            file = folder / "cost.json"
            try:
                found.append(Cost.of(read_json(file), str(file)))
            except UserError as error:
                raise UserError(
                    f"{file}: missing or not written by mjforage; delete {folder} and "
                    f"{again(self.path)}"
                ) from error
        return found

    def merge(self, chunks: list[Chunk]) -> None:
        """Join the chunks' tables in order and write them beside `run.json`.

        Raises
        ------
        UserError
            If a table cannot be written.
        """
        for table in TABLES:
            target = self.path / f"{table}.parquet"
            temporary = target.with_name(f".{target.name}.{os.getpid()}")
            sources = [self._chunks / chunk.name / f"{table}.parquet" for chunk in chunks]
            with writing(target):
                try:
                    frame = pl.scan_parquet(sources, glob=False)
                    frame.sink_parquet(temporary, compression="zstd")
                    temporary.replace(target)
                finally:
                    temporary.unlink(missing_ok=True)

    def finish(self, chunks: list[Chunk]) -> None:
        """Remove the chunks of a complete run, and what killed runs were writing.

        Everything that chunks hold is in the merged tables.
        """
        for name in (*(f"{table}.parquet" for table in TABLES), "run.json", "summary.json"):
            for leftover in self.path.glob(f".{name}.*"):
                leftover.unlink(missing_ok=True)
        for folder in (*(self._chunks / chunk.name for chunk in chunks), *self._chunks.glob(".*")):
            shutil.rmtree(folder, ignore_errors=True)
        with contextlib.suppress(OSError):  # something else is in it, and stays
            self._chunks.rmdir()

    def table(self, name: str) -> pl.DataFrame:
        """A merged table.

        Raises
        ------
        UserError
            If it is missing, truncated or foreign.
        """
        path = self.path / f"{name}.parquet"
        return read_table(path, name, self._moved(path))

    def episodes(self, chunks: list[Chunk]) -> pl.DataFrame:
        """The merged table of episodes.

        Raises
        ------
        UserError
            If it is missing, truncated or foreign, or does not hold the episodes of the chunks.
        """
        path, table = self.path / "episodes.parquet", self.table("episodes")
        keys = [key for chunk in chunks for key in chunk.keys]
        _check_keys(path, table, keys, self._moved(path))
        return table

    def _moved(self, what: Path) -> str:
        """Remedy for a spoilt file or folder of this run."""
        return f"move {what} away and {again(self.path)}"


def _check_keys(
    path: Path, frame: pl.DataFrame, keys: list[tuple[str, str, int]], remedy: str
) -> None:
    found = set(frame.select(*KEYS).unique().rows())
    if found != set(keys):
        raise UserError(f"{path}: does not hold the {len(keys)} episodes that it should; {remedy}")
