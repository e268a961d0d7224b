"""Parquet files, read and written in one way: errors name a missing, damaged or foreign file."""

import io
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import polars as pl

from mjforage.base.atomic_files import atomic_write
from mjforage.base.errors import UserError
from mjforage.scenario.sizes import check_memory

UNPACKED = 40  # bytes of a number in memory, with the copies that are made of a table
_AGAIN = "run what wrote it again"
FAILURES = (OSError, pl.exceptions.PolarsError, pl.exceptions.PanicException)


def read_schema(path: Path, remedy: str = "") -> dict[str, pl.DataType]:
    """Columns and their types, in order.

    Raises `UserError` if the file is missing, truncated or not Parquet.

    Parameters
    ----------
    path : Parquet file
    remedy : last words of a message; to move the file away and compute it again if empty
    """
    if not path.exists():
        raise UserError(f"{path}: missing, as in a run that is not finished; {remedy or _AGAIN}")
    try:
        if not path.is_file():
            raise FileNotFoundError("no file")
        return dict(pl.scan_parquet(path, glob=False).collect_schema())
    except FAILURES as error:
        raise UserError(
            f"{path}: missing, truncated or not Parquet ({_reason(error)}); "
            f"{remedy or spoilt(path)}"
        ) from error


def read_parquet(
    path: Path,
    columns: Sequence[str] | None = None,
    rows: pl.Expr | None = None,
    remedy: str = "",
) -> pl.DataFrame:
    """A table, or some columns and rows of it.

    Raises `UserError` as `read_schema`, and if a column is missing, the file is damaged inside, or
    unpacks to more than this machine has memory for.

    Parameters
    ----------
    path, remedy : as for `read_schema`
    columns : all of them if None
    rows : rows to read; all of them if None
    """
    frame = scan_parquet(path, columns, remedy)
    if rows is None:
        number = count_rows(path, remedy)
        wanted = UNPACKED * number * len(frame.collect_schema())
        check_memory(f"{path}: {number:,} rows", wanted, remedy or spoilt(path))
    return collected(path, frame if rows is None else frame.filter(rows), remedy)


def count_rows(path: Path, remedy: str = "") -> int:
    """Number of rows in a table's footer, without reading a row; raises as `collected`."""
    return int(collected(path, pl.scan_parquet(path, glob=False).select(pl.len()), remedy).item())


def scan_parquet(
    path: Path, columns: Sequence[str] | None = None, remedy: str = ""
) -> pl.LazyFrame:
    """A table of which nothing is read yet, for those too large to be held; `collected` reads it.

    Raises `UserError` as `read_schema`, and if a column is missing.

    `path`, `columns`, `remedy`: as for `read_parquet`.
    """
    schema = read_schema(path, remedy)
    for name in columns or ():
        if name not in schema:
            raise UserError(
                f"{path}: column '{name}' is missing, not a log of mjforage; "
                f"{remedy or spoilt(path)}"
            )
    frame = pl.scan_parquet(path, glob=False)
    return frame if columns is None else frame.select(columns)


def collected(path: Path, frame: pl.LazyFrame, remedy: str = "") -> pl.DataFrame:
    """Rows of a lazy query of a table; raises `UserError` if the file is damaged inside."""
    try:
        return frame.collect()
    except FAILURES as error:
        raise UserError(f"{path}: damaged ({_reason(error)}); {remedy or spoilt(path)}") from error


def parquet_bytes(frame: pl.DataFrame) -> bytes:
    """A table as the content of a file; Python then reports a full disk in words."""
    buffer = io.BytesIO()
    frame.write_parquet(buffer, compression="zstd")
    return buffer.getvalue()


def join_parquet(sources: Iterable[Path], target: Path) -> None:
    """Write the rows of several files, in their order, into one, without holding them all.

    A number that some of them have no column for is undefined in their rows: NaN. Raises
    `UserError` if the target cannot be written.
    """
    with atomic_write(target, pl.exceptions.PolarsError) as beside:
        frame = pl.scan_parquet(files := list(sources), glob=False)
        schemas = [read_schema(file) for file in files]
        if any(schema != schemas[0] for schema in schemas):
            frame = pl.concat([pl.scan_parquet(file, glob=False) for file in files], how="diagonal")
            some = {name for one in schemas for name in one if any(name not in s for s in schemas)}
            frame = frame.with_columns(pl.col(*some).fill_null(math.nan))
        frame.sink_parquet(beside, compression="zstd")


def spoilt(path: Path, again: str = _AGAIN) -> str:
    """The remedy for a spoilt file or folder; `again`: what makes it, by default not known."""
    return f"move {path} away and {again}"


def _reason(error: Exception) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__
