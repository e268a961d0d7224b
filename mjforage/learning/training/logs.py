"""Logs of a training run: Parquet tables, and the same numbers for TensorBoard."""

from pathlib import Path

import polars as pl

from mjforage.base.atomic_files import write_bytes
from mjforage.base.errors import UserError
from mjforage.base.extras import require
from mjforage.learning.training.progress import Progress, Row
from mjforage.runs.parquet import parquet_bytes, read_parquet, read_schema

TABLES = ("training", "evaluations")


class Logs:
    """Tables `training.parquet` (a row per round) and `evaluations.parquet` of a folder.

    Resuming drops rows that are younger than the checkpoint: those rounds are played again. Raises
    `UserError` if a table of the folder cannot be read.
    """

    def __init__(self, folder: Path, progress: Progress) -> None:
        require("train: its log", "tensorboard")
        from torch.utils.tensorboard import SummaryWriter

        self._folder = folder
        self._rows: dict[str, list[Row]] = {}
        for name in TABLES:
            path = folder / f"{name}.parquet"
            self._rows[name] = _read(path, progress.rounds) if path.is_file() else []
        first = progress.updates + 1 if progress.rounds else 0
        self._board = SummaryWriter(str(folder / "tensorboard"), purge_step=first)

    def add(self, table: str, row: Row) -> None:
        """Append a row."""
        self._rows[table].append(row)
        for name, value in row.items():
            if name not in ("rounds", "updates", "seconds"):
                self._board.add_scalar(f"{table}/{name}", value, int(row["updates"]))

    def write(self) -> None:
        """Put the tables on disk, each through a temporary file."""
        self._board.flush()
        for name, rows in self._rows.items():
            write_bytes(self._folder / f"{name}.parquet", parquet_bytes(pl.DataFrame(rows)))

    def close(self) -> None:
        """Write and let go."""
        self.write()
        self._board.close()


def _read(path: Path, rounds: int) -> list[Row]:
    """Rows of a table up to a round."""
    remedy = "move it away, or give another folder"
    kinds = read_schema(path, remedy)  # none before the first evaluation
    if kinds and not kinds.get("rounds", pl.String()).is_numeric():
        raise UserError(f"{path}: is no log of a training; {remedy}")
    table = read_parquet(path, remedy=remedy)
    return table.filter(pl.col("rounds") <= rounds).to_dicts() if table.height else []
