"""Run folders: what identifies a run, its finished chunks, and the tables merged from them.

A chunk is a folder of four Parquet files that appears whole or not at all (written beside, then
renamed), so a killed run resumes where it stopped. `run.json` is written first, `summary.json`
last; a folder with both is complete.
"""

import contextlib
import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import polars as pl

from mjforage.errors import UserError
from mjforage.run_info import read_json
from mjforage.scenario_file import canonical_json
from mjforage.tables import SCHEMAS, TABLES

IDENTITY = ("scenario", "map", "versions", "seed", "episodes", "worlds", "policies")
_COMPARED_VERSIONS = ("mjforage", "mujoco")


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
        return f"{self.world}-{self.policy}-{self.first:06d}-{self.count}"


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
    except (OSError, pl.exceptions.PolarsError) as error:
        reason = getattr(error, "strerror", None) or str(error).splitlines()[0]
        raise UserError(
            f"{path}: cannot be written ({reason}); free some space or choose another --out, then "
            "run the same command again: finished chunks are kept"
        ) from error


def write_json(path: Path, value: object) -> None:
    """Write JSON through a temporary file, so that the file is whole or absent.

    Raises
    ------
    UserError
        If it cannot be written.
    """
    with writing(path):
        temporary = path.with_name(f".{path.name}.{os.getpid()}")
        try:
            temporary.write_text(json.dumps(value, indent=1, allow_nan=False) + "\n", "utf-8")
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)


def run_hash(info: Mapping[str, Any]) -> str:
    """Hash of scenario, map and the package and MuJoCo versions: 16 hexadecimal digits."""
    versions = {name: info["versions"][name] for name in _COMPARED_VERSIONS}
    text = canonical_json([info["scenario"], info["map"], versions])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _differences(there: object, here: object, key: str) -> Iterator[str]:
    if isinstance(there, dict) and isinstance(here, dict):
        for name in {**there, **here}:
            yield from _differences(there.get(name), here.get(name), f"{key}.{name}".lstrip("."))
    elif there != here:
        if key == "map.navigable":
            yield "the map's cells differ"
        else:
            yield f"{key} is {json.dumps(there)} there and {json.dumps(here)} here"


class RunFolder:
    """The folder of one run."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._chunks = path / "chunks"

    def open(self, info: Mapping[str, Any]) -> None:
        """Create the folder for a run, or check that it holds the same one.

        Parameters
        ----------
        info : content of `run.json`

        Raises
        ------
        UserError
            If the folder holds another run (the difference is named) or something else, or cannot
            be written.
        """
        file = self.path / "run.json"
        if file.is_file():
            self._check_same(read_json(file), info)
        elif self.path.is_dir() and any(
            not entry.name.startswith(".") for entry in self.path.iterdir()
        ):
            raise UserError(f"{self.path}: not empty and without run.json; choose another --out")
        with writing(self.path):
            self._chunks.mkdir(parents=True, exist_ok=True)
            for stale in self._chunks.glob(".*"):
                shutil.rmtree(stale)
        if not file.is_file():
            write_json(file, info)

    def _check_same(self, there: dict[str, Any], here: Mapping[str, Any]) -> None:
        def identity(info: Mapping[str, Any]) -> dict[str, Any]:
            part = {key: info.get(key) for key in IDENTITY}
            versions = info.get("versions") or {}
            part["versions"] = {name: versions.get(name) for name in _COMPARED_VERSIONS}
            return part

        found = list(_differences(identity(there), identity(json.loads(json.dumps(here))), ""))
        if found:
            raise UserError(
                f"{self.path}: holds another run: {'; '.join(found[:3])}; choose another --out"
            )

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
            If its files are truncated, foreign or of the wrong size.
        """
        folder = self._chunks / chunk.name
        if not folder.is_dir():
            return False
        for table in TABLES:
            _check_table(folder / f"{table}.parquet", table)
        if _rows(folder / "episodes.parquet") != chunk.count:
            raise UserError(
                f"{folder}: does not hold {chunk.count} episodes; delete it and run again"
            )
        return True

    def write(
        self, chunk: Chunk, frames: Mapping[str, pl.DataFrame], timings: Mapping[str, float]
    ) -> None:
        """Store a finished chunk, whole or not at all.

        Raises
        ------
        UserError
            If it cannot be written.
        """
        with writing(self._chunks / chunk.name):
            temporary = Path(tempfile.mkdtemp(prefix=".", dir=self._chunks))
            try:
                for name, frame in frames.items():
                    frame.write_parquet(temporary / f"{name}.parquet", compression="zstd")
                (temporary / "timings.json").write_text(json.dumps(timings), "utf-8")
                temporary.rename(self._chunks / chunk.name)
            finally:
                shutil.rmtree(temporary, ignore_errors=True)

    def timings(self, chunks: list[Chunk]) -> dict[str, float]:
        """Sum of the chunks' timings [s]."""
        total: dict[str, float] = {}
        for chunk in chunks:
            for key, value in read_json(self._chunks / chunk.name / "timings.json").items():
                total[key] = total.get(key, 0.0) + float(value)
        return total

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
                    pl.scan_parquet(sources).sink_parquet(temporary, compression="zstd")
                    temporary.replace(target)
                finally:
                    temporary.unlink(missing_ok=True)

    def finish(self) -> None:
        """Remove the chunks of a complete run: everything they hold is in the merged tables."""
        shutil.rmtree(self._chunks, ignore_errors=True)

    def table(self, name: str) -> pl.DataFrame:
        """A merged table.

        Raises
        ------
        UserError
            If it is missing, truncated or foreign.
        """
        path = self.path / f"{name}.parquet"
        _check_table(path, name)
        return pl.read_parquet(path)


def _rows(path: Path) -> int:
    return int(pl.scan_parquet(path).select(pl.len()).collect().item())


def _check_table(path: Path, table: str) -> None:
    try:
        schema = pl.scan_parquet(path).collect_schema()
        _rows(path)
    except (OSError, pl.exceptions.PolarsError) as error:
        raise UserError(
            f"{path}: missing, truncated or not Parquet ({str(error).splitlines()[0]}); delete "
            f"{path.parent if path.parent.parent.name == 'chunks' else path} and run evaluate again"
        ) from error
    if dict(schema) != SCHEMAS[table]:
        wrong = set(schema) ^ set(SCHEMAS[table])
        raise UserError(
            f"{path}: not a table of {table} ({', '.join(sorted(wrong)) or 'column types'} differ); "
            "move it away and run evaluate again"
        )
