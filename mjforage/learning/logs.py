"""Logs of a training run: Parquet tables, and the same numbers for TensorBoard."""

from pathlib import Path

import polars as pl

from mjforage.learning.training import Row
from mjforage.storage import writing

TABLES = ("training", "evaluations")


class Logs:
    """Tables `training.parquet` (a row per round) and `evaluations.parquet` of a folder.

    Resuming drops rows that are younger than the checkpoint: those rounds are played again.
    """

    def __init__(self, folder: Path, updates: int) -> None:
        from torch.utils.tensorboard import SummaryWriter

        self._folder = folder
        self._rows: dict[str, list[Row]] = {}
        for name in TABLES:
            path = folder / f"{name}.parquet"
            old = pl.read_parquet(path).to_dicts() if path.is_file() else []
            self._rows[name] = [row for row in old if row["updates"] <= updates]
        self._board = SummaryWriter(
            str(folder / "tensorboard"), purge_step=updates + 1 if updates else None
        )

    def add(self, table: str, row: Row) -> None:
        """Append a row."""
        self._rows[table].append(row)
        for name, value in row.items():
            if name not in ("updates", "seconds"):
                self._board.add_scalar(f"{table}/{name}", value, int(row["updates"]))

    def last(self, table: str) -> Row | None:
        """The latest row, if there is one."""
        return self._rows[table][-1] if self._rows[table] else None

    def write(self) -> None:
        """Put the tables on disk, each through a temporary file."""
        self._board.flush()
        for name, rows in self._rows.items():
            path = self._folder / f"{name}.parquet"
            beside = path.with_suffix(".part")
            with writing(path):
                pl.DataFrame(rows).write_parquet(beside)
                beside.replace(path)

    def close(self) -> None:
        """Write and let go."""
        self.write()
        self._board.close()
