"""Run the long blocks of pages as they stand: `python -m tests.documents [--list] [PAGE ...]`.

All blocks of a page are run in its order in one empty folder, those that make what a long block
needs too; pages without a long block are left out. Exit code 1 if a block fails. It takes hours.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.documents.blocks import REPOSITORY, SHELL, Block, blocks, pages

PROGRAMS = {"mjforage": "-m mjforage", "python": ""}
"""Name -> what this Python is given to be it."""


def surroundings(folder: Path) -> dict[str, str]:
    """Make commands of this checkout in a folder, and return what finds them."""
    place = folder / ".bin"
    place.mkdir()
    for name, given in PROGRAMS.items():
        (place / name).write_text(f'#!/bin/sh\nexec "$PYTHON_OF_DOCUMENTS" {given} "$@"\n')
        (place / name).chmod(0o755)
    path = f"{place}{os.pathsep}{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    told = {"PYTHONPATH": os.fspath(REPOSITORY), "PYTHON_OF_DOCUMENTS": sys.executable}
    return {**os.environ, **told, "PATH": path}


def run(block: Block, folder: Path, told: dict[str, str]) -> int:
    """Run a block, or save the file that it is; return its exit code."""
    if block.file:
        (folder / block.file).write_text(block.text)
        return 0
    if block.language == SHELL:
        command = ["bash", "-euo", "pipefail", "-c", block.text]
    elif block.language == "python":
        command = [sys.executable, "-c", block.text]
    else:
        return 0
    return subprocess.run(command, cwd=folder, env=told, stdin=subprocess.DEVNULL).returncode


def run_page(page: str, folder: Path) -> list[Block]:
    """Run a page's blocks and return those that failed."""
    told, failed = surroundings(folder), []
    for block in blocks(page):
        if not (block.runs or block.long):
            continue
        begun = time.monotonic()
        if run(block, folder, told):
            failed.append(block)
        elif block.long:
            sys.stdout.write(f"{block}: {time.monotonic() - begun:.0f} s\n")
            sys.stdout.flush()
    return failed


def main() -> None:
    """Run or list the long blocks."""
    parser = argparse.ArgumentParser(prog="python -m tests.documents", description=__doc__)
    parser.add_argument("pages", nargs="*", metavar="PAGE", help="such as docs/studies.md")
    parser.add_argument("--list", action="store_true", help="name the long blocks, run none")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="keep what a page makes here")
    chosen = parser.parse_args()
    if unknown := set(chosen.pages) - set(pages()):
        sys.exit(f"documents: {', '.join(sorted(unknown))} unknown; name pages as docs/studies.md")
    failed = []
    for page in chosen.pages or pages():
        long = [block for block in blocks(page) if block.long]
        if chosen.list:
            sys.stdout.writelines(f"{block}\n{block.text}\n" for block in long)
        elif long:
            with tempfile.TemporaryDirectory() as folder:
                failed += run_page(page, Path(folder))
                if chosen.keep:
                    name = page.removesuffix(".md").replace("/", "-")
                    shutil.copytree(folder, chosen.keep / name, dirs_exist_ok=True, symlinks=True)
    if failed:
        sys.exit("documents: failed: " + ", ".join(map(str, failed)))


if __name__ == "__main__":
    main()
