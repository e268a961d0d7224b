"""Kernels of a copy of the repository as the plain Python that they are written in.

Short checks take less time without the compiler. With it, kernels on disk go by their content: a
fault has those compiled anew that contain it, and no other.
"""

from pathlib import Path

COMPILER = "mjforage/base/compiled.py"
COMPILING = "    outer = dispatcher(bare=False)"


def interpreted(copy: Path) -> None:
    """Let the copy's kernels be plain Python.

    Raises
    ------
    ValueError
        If the file does not say any more how kernels are compiled.
    """
    path = copy / COMPILER
    text = path.read_text(encoding="utf-8")
    if text.count(COMPILING) != 1:
        raise ValueError(f"{COMPILER} has no line {COMPILING!r}; see tests/mutants/kernels.py")
    path.write_text(text.replace(COMPILING, f"    return function\n{COMPILING}"), encoding="utf-8")
