"""Run the long blocks of pages as they stand: `python -m tests.documents [--keep DIR] [PAGE ...]`.

All blocks of a page are run in its order in one empty folder, those that make what a long block
needs too; pages without a long block are left out. Exit code 1 if a block fails. It takes hours.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.documents.blocks import REPOSITORY, SHELL, Block, blocks, pages

PROGRAMS = {"mjforage": "-m mjforage", "python": ""}
"""Name -> what this Python is given to be it."""


def environment(folder: Path) -> dict[str, str]:
    """Make commands of this checkout in a folder, and return the variables that find them."""
    place = folder / ".bin"
    place.mkdir(parents=True, exist_ok=True)
    for name, given in PROGRAMS.items():
        (place / name).write_text(f'#!/bin/sh\nexec "{sys.executable}" {given} "$@"\n')
        (place / name).chmod(0o755)
    path = f"{place}{os.pathsep}{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return {**os.environ, "PYTHONPATH": os.fspath(REPOSITORY), "PATH": path}


def run(block: Block, folder: Path, env: dict[str, str]) -> int:
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
    return subprocess.run(command, cwd=folder, env=env, stdin=subprocess.DEVNULL).returncode


def run_page(page: str, folder: Path) -> list[Block]:
    """Run a page's blocks and return those that failed."""
    env, failed = environment(folder), []
    for block in blocks(page):
        if block.mark and not block.long:
            continue
        begun = time.monotonic()
        if run(block, folder, env):
            failed.append(block)
        sys.stdout.write(f"{block}: {time.monotonic() - begun:.0f} s\n")
        sys.stdout.flush()
    return failed


def main() -> None:
    """Run the long blocks."""
    parser = argparse.ArgumentParser(prog="python -m tests.documents", description=__doc__)
    parser.add_argument("pages", nargs="*", metavar="PAGE", help="such as docs/studies.md")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="keep what a page makes here")
    chosen = parser.parse_args()
    failed = []
    with tempfile.TemporaryDirectory() as temporary:
        for page in chosen.pages or pages():
            if any(block.long for block in blocks(page)):
                name = page.removesuffix(".md").replace("/", "-")
                failed += run_page(page, (chosen.keep or Path(temporary)) / name)
    if failed:
        sys.exit("documents: failed: " + ", ".join(map(str, failed)))


if __name__ == "__main__":
    main()
