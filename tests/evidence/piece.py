"""Pieces of evidence: `docs/evidence/data/NAME.json`, what a table shows and where it comes from.

A file holds the piece's commands under labels (`runs`), its columns and its rows, and names the
files that are written whole. Numbers are in full; the columns say how pages show them. A number of
a table is made from what its piece, column and row say together (`of`, `Spec`); words stay as they
stand. A new number begins as `{}`.
"""

import hashlib
import json
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from platform import python_version
from typing import Any, NamedTuple

import torch

REPOSITORY = Path(__file__).parents[2]
DATA = REPOSITORY / "docs" / "evidence" / "data"
CODE = ("mjforage", "metrics", "controllers", "graph_planner", "models")
LIBRARIES = ("numpy", "numba", "scipy", "mujoco", "torch", "torchrl")
"""Those whose version may change a number."""

Cell = str | dict[str, float] | None
"""Words, a number with what is known of it, or nothing.

Keys of a number: `mean` of the episodes, `gap` to another mean over the same episodes, `half` of
the interval of the last of these, or the ends `low` and `high` of its interval, `rough`; `n`
episodes in which all of that is defined. Undefined numbers are left out.
"""
Spec = dict[str, Any]
"""`way` of `tables.number`; `run` (label of a command; in a column `{}` is the row's), `variant` of
a study, `policy`, `world`, `key` of a metric; `minus`: those of these that differ in what is
compared."""


class Column(NamedTuple):
    """Head of a column, the form of its numbers and where they come from."""

    head: str
    form: str = ""  # `.2f`: decimals, of a difference at most; `.3g`: significant digits
    of: Spec = {}  # noqa: RUF012 - nobody writes to it


class Row(NamedTuple):
    """Cells of a row, and where their numbers come from."""

    cells: Sequence[Cell]
    of: Spec = {}  # noqa: RUF012


@dataclass(frozen=True)
class Piece:
    """A table of pages, or files that are written whole, or both."""

    name: str
    runs: Mapping[str, dict[str, Any]]  # label -> `command`, and seed, hash and so on of its run
    columns: Sequence[Column] = ()
    rows: Sequence[Row] = ()
    of: Spec | None = None
    files: Sequence[str] = ()  # from the repository's folder
    shown: bool = True  # whether its region has the commands; not, where one before it has them
    made: Mapping[str, Any] | None = None  # with what and when

    def spec(self, column: Column, row: Row) -> Spec:
        """The origin of a number: piece, column and row together."""
        levels = (self.of or {}, column.of, row.of)
        found = {key: value for level in levels for key, value in level.items()}
        minus = {k: v for level in levels for k, v in level.get("minus", {}).items()}
        label = row.of.get("run", "")
        template = {**levels[0], **column.of}.get("run", "{}")
        found["run"] = template.format(label)
        if "run" in minus:
            minus["run"] = minus["run"].format(label)
        return {**found, "minus": minus}

    @property
    def current(self) -> bool:
        """True if its numbers are of this very code."""
        return self.made is not None and self.made["code"] == provenance()["code"]


def load(name: str, folder: Path = DATA) -> Piece:
    """Read a piece."""
    content = json.loads((folder / f"{name}.json").read_text("utf-8"))
    columns = [Column(*column) for column in content.pop("columns", ())]
    rows = [Row(**row) for row in content.pop("rows", ())]
    return Piece(name, columns=columns, rows=rows, **content)


def pieces(folder: Path = DATA) -> list[str]:
    """Names of all pieces."""
    return sorted(path.stem for path in folder.glob("*.json"))


def save(piece: Piece, folder: Path = DATA) -> None:
    """Write a piece, a command, column or row on a line."""
    columns = [[*column[:2], *([column.of] if column.of else [])] for column in piece.columns]
    rows = [{"cells": row.cells} | ({"of": row.of} if row.of else {}) for row in piece.rows]
    parts = {
        "made": piece.made,
        "runs": piece.runs,
        "files": piece.files,
        "of": piece.of,
        "shown": None if piece.shown else False,
        "columns": columns,
        "rows": rows,
    }
    lines = (f' "{name}": {_lines(part)}' for name, part in parts.items() if part or part is False)
    (folder / f"{piece.name}.json").write_text("{\n" + ",\n".join(lines) + "\n}\n", "utf-8")


def _lines(part: Any) -> str:
    """JSON, an entry of a list or mapping on a line."""
    if isinstance(part, dict):
        entries = [f"{_json(key)}: {_json(value)}" for key, value in part.items()]
        return "{\n  " + ",\n  ".join(entries) + "\n }"
    return "[\n  " + ",\n  ".join(map(_json, part)) + "\n ]" if part else _json(part)


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def made(piece: Piece, runs: Mapping[str, dict[str, Any]], rows: Sequence[Row]) -> Piece:
    """A piece that has been made today, with what is known of its runs."""
    date = {"date": f"{datetime.now(UTC):%Y-%m-%d}"}
    return replace(piece, runs=runs, rows=rows, made=date | provenance())


@cache
def provenance() -> dict[str, Any]:
    """Version, commit, hash of all code and models, versions of libraries, and the processor's
    instructions that torch uses, of this process.

    `-dirty` behind the commit says that code or models were changed since.
    """
    git = ["git", "-C", str(REPOSITORY)]
    asked = [*git, "rev-parse", "--short=12", "HEAD"]
    commit = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()
    asked = [*git, "diff", "--quiet", "HEAD", "--", *CODE, ":!*.md"]
    changed = subprocess.run(asked, check=False).returncode
    return {
        "mjforage": version("mjforage"),
        "commit": commit + ("-dirty" if changed else ""),
        "code": _code_hash(),
        "versions": {"python": python_version()} | dict(_versions()),
        "instructions": torch.backends.cpu.get_cpu_capability(),
    }


def _code_hash() -> str:
    """16 hexadecimal digits that tell this code and these models from others."""
    found = hashlib.sha256()
    for path in sorted(path for top in CODE for path in (REPOSITORY / top).rglob("*")):
        if path.is_file() and "__pycache__" not in path.parts and path.suffix != ".md":
            found.update(path.relative_to(REPOSITORY).as_posix().encode() + b"\0")
            found.update(path.read_bytes())
    return found.hexdigest()[:16]


def _versions() -> Iterator[tuple[str, str]]:
    for name in LIBRARIES:
        try:
            yield name, version(name)
        except PackageNotFoundError:
            continue
