"""What has to be compiled again for a fault: the kernels of files that import the spoilt one.

Kernels of the project are compiled again when any of its files changes. In the copy a kernel goes
by the text of its own file alone, as numba has it, and the files that import the spoilt file, be it
by way of others, get a new last line: whatever could have compiled the fault into itself is
compiled anew, and nothing else. Short checks take less time in a copy without the compiler, where
kernels are the Python that they are written in.
"""

import ast
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

STAMP = "    found = [(str(file), file.stat().st_mtime_ns, file.stat().st_size) for file in files]"
PACKAGE = "mjforage"


def stamped_by_file(copy: Path) -> None:
    """Let the copy's kernels go by their own files.

    Raises
    ------
    ValueError
        If `graph_planner/compiled.py` does not say any more how kernels are stamped.
    """
    path = copy / "graph_planner" / "compiled.py"
    text = path.read_text(encoding="utf-8")
    if text.count(STAMP) != 1:
        raise ValueError(f"{path.name} has no line {STAMP.strip()!r}; see tests/mutants/kernels.py")
    path.write_text(text.replace(STAMP, "    found = [str(source), len(files)]"), encoding="utf-8")


COMPILING = "    outer = dispatcher(bare=False)"
COMPILERS = ("graph_planner/compiled.py", "controllers/_compiled.py")


def interpreted(copy: Path) -> None:
    """Let the copy's kernels be plain Python.

    Raises
    ------
    ValueError
        If a file does not say any more how kernels are compiled.
    """
    for name in COMPILERS:
        text = (copy / name).read_text(encoding="utf-8")
        if text.count(COMPILING) != 1:
            raise ValueError(f"{name} has no line {COMPILING!r}; see tests/mutants/kernels.py")
        plain = text.replace(COMPILING, f"    return function\n{COMPILING}")
        (copy / name).write_text(plain, encoding="utf-8")


def importers(file: Path, copy: Path) -> set[Path]:
    """The file, and all of the package that import it, directly or not."""
    imports = {path: _imports(path, copy) for path in (copy / PACKAGE).rglob("*.py")}
    found, new = {file}, {file}
    while new:
        new = {path for path, used in imports.items() if used & new} - found
        found |= new
    return found


def _imports(path: Path, copy: Path) -> set[Path]:
    """Files of the package that a file names in its imports."""
    used = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            names = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        for name in names:
            place = copy / name.replace(".", "/")
            used |= {place.with_suffix(".py"), place / "__init__.py"}
    return used


@contextmanager
def recompiled(file: Path, copy: Path, store: Path) -> Iterator[None]:
    """Within it, kernels that may contain the file's are compiled anew; then all is as before.

    Parameters
    ----------
    store : a folder of its own beside the copy, for what was compiled before
    """
    files = importers(file, copy) - {file} if file.suffix == ".py" else set()
    kept = {path: (path.read_bytes(), path.stat().st_mtime_ns) for path in files}
    folders = sorted({path.parent / "__pycache__" for path in (*files, file)})
    stored = {folder: store / str(number) for number, folder in enumerate(folders)}
    for folder, place in stored.items():
        if folder.is_dir():
            shutil.copytree(folder, place)
    for path, (text, _) in kept.items():
        path.write_bytes(text + f"# {time.time_ns()}\n".encode())
    try:
        yield
    finally:
        for path, (text, when) in kept.items():
            path.write_bytes(text)
            os.utime(path, ns=(when, when))
        for folder, place in stored.items():
            shutil.rmtree(folder, ignore_errors=True)
            if place.is_dir():
                shutil.move(place, folder)
