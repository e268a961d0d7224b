"""`docs/evidence/data/NAME.json`: the numbers of a piece, and where they come from."""

import hashlib
import json
import subprocess
from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from platform import python_version
from typing import Any

import torch

from mjforage.base.atomic_files import write_bytes
from mjforage.runs.source_code import COMPUTING, OURS
from tests.evidence.piece import REPOSITORY, Piece
from tests.evidence.playing import Runs, told

DATA = REPOSITORY / "docs" / "evidence" / "data"
CODE = (*OURS, "models")

Data = dict[str, Any]
"""`made`: with what and when; `runs`: label -> command, seed, episodes, hash and CPU
minutes; `rows` of the table, or `files`: path -> digest."""


def file_of(piece: Piece, folder: Path = DATA) -> Path:
    """Where the data of a piece lie."""
    return folder / f"{piece.name}.json"


def load(piece: Piece, folder: Path = DATA) -> Data:
    """Read the data of a piece.

    Raises
    ------
    FileNotFoundError
        If it has none.
    """
    content: Data = json.loads(file_of(piece, folder).read_text("utf-8"))
    return content


def save(piece: Piece, content: Data, folder: Path = DATA) -> None:
    """Write the data of a piece, a row of its table on a line."""
    rest = json.dumps({**content, "rows": None}, indent=1, ensure_ascii=False)
    lines = ",\n".join(
        "  " + json.dumps(row, ensure_ascii=False, allow_nan=False) for row in content["rows"]
    )
    text = rest.replace('"rows": null', f'"rows": [\n{lines}\n ]' if lines else '"rows": []')
    write_bytes(file_of(piece, folder), (text + "\n").encode())


def gathered(piece: Piece, folders: Mapping[str, Path], date: str = "") -> Data:
    """The data of a piece whose commands have been run."""
    runs = Runs(folders)
    rows = [list(row) for row in piece.rows(runs)]
    piece.write(runs)
    return {
        "made": {"date": date or f"{datetime.now(UTC):%Y-%m-%d}", **provenance()},
        "runs": {
            label: {"command": command, **told(folders[label])}
            for label, command in piece.runs.items()
        },
        "files": {name: digest(REPOSITORY / name) for name in piece.files},
        "rows": rows,
    }


@cache
def provenance() -> dict[str, Any]:
    """Version, commit, a hash of all code and models, versions of libraries, and the processor's
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
        "code": code_hash(),
        "versions": {"python": python_version()} | _versions(),
        "instructions": torch.backends.cpu.get_cpu_capability(),
    }


def code_hash() -> str:
    """16 hexadecimal digits that tell this code and these models from others."""
    found = hashlib.sha256()
    for top in CODE:
        for path in sorted((REPOSITORY / top).rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts and path.suffix != ".md":
                found.update(path.relative_to(REPOSITORY).as_posix().encode() + b"\0")
                found.update(path.read_bytes())
    return found.hexdigest()[:16]


def _versions() -> dict[str, str]:
    found = {}
    for name in COMPUTING:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def digest(file: Path) -> str:
    """16 hexadecimal digits of a file; of a page of its tables, blocks and lines that name a commit
    alone, as words may be mended.
    """
    content = file.read_bytes()
    if file.suffix == ".md":
        content = b"\n".join(_told(content.splitlines()))
    return hashlib.sha256(content).hexdigest()[:16]


def _told(lines: Iterable[bytes]) -> Iterator[bytes]:
    """Lines of a page that no hand mends."""
    within = False
    for line in lines:
        fence = line.startswith(b"```")
        if within or fence or line.startswith(b"|") or b"commit " in line:
            yield line
        within ^= fence


def current(piece: Piece, folder: Path = DATA) -> bool:
    """Whether the data of a piece are of its commands and of this very code."""
    try:
        content = load(piece, folder)
    except FileNotFoundError:
        return False
    made = content["made"]
    return commands(content) == dict(piece.runs) and made["code"] == code_hash()


def cpu_minutes(content: Data) -> float | None:
    """CPU minutes of all runs together; None of commands that leave no run to tell them."""
    each = [run["cpu_minutes"] for run in content["runs"].values() if "cpu_minutes" in run]
    return sum(each) if each else None


def commands(content: Data) -> dict[str, str]:
    """The commands of which data are."""
    return {label: run["command"] for label, run in content["runs"].items()}
