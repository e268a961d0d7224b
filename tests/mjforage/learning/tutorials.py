"""The tutorials of docs/learning, trained as they stand, and what their policies come to.

    python -m tests.mjforage.learning.tutorials --json found.json

runs the blocks of each page that train, with the page's own numbers of decisions, and plays the
policies that they leave, and ours, in the same episodes of `comb-port`.
"""

import argparse
import json
import os
import runpy
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import polars as pl
from sb3_contrib import MaskablePPO

from mjforage.api.models import policy_of_model
from mjforage.graph_planner.policies import create_policy
from tests.controllers.proving_ground import say
from tests.documents.blocks import REPOSITORY, blocks
from tests.mjforage.learning.reward_table import played

SCENARIO, EPISODES, POINTS = "comb-port", 100, 40
SHIPPED = ("random", "greedy", "auction", "belief", "ddqn", "mappo")
PAGES = {"twenty_lines": ("twenty_lines",), "fleet": ("fleet",), "hulls": ("graph", "physics")}
"""Page -> labels of its trainings."""
Curve = list[list[float]]
"""Decisions so far and PTA_C [%] of the episodes that ended since the point before."""


def trainings(page: str) -> Iterator[str]:
    """Scripts of a page: all up to the end of its first training, what is up to the next, ..."""
    script, left = "", len(PAGES[page])
    for block in blocks(f"docs/learning/{page}.md"):
        if block.language == "python" and not block.file and left:
            script += block.text
            if ".learn(" in block.text or "Collector(" in block.text:
                yield script
                script, left = "import sys\n" + _imports(script), left - 1


def _imports(script: str) -> str:
    lines = (line for line in script.splitlines() if line.startswith(("import ", "from ")))
    return "\n".join([*lines, ""])


def train(page: str, folder: Path) -> Iterator[dict[str, Any]]:
    """Train what a page trains, in a folder; yield label, CPU minutes and curve of each."""
    folder.mkdir(parents=True)
    for block in blocks(f"docs/learning/{page}.md"):
        if block.file:
            (folder / block.file).write_text(block.text)
    env = {**os.environ, "PYTHONPATH": os.fspath(REPOSITORY)}
    for label, script in zip(PAGES[page], trainings(page), strict=True):
        before = os.times()
        command = [sys.executable, "-W", "ignore", "-c", script]
        subprocess.run(command, cwd=folder, env=env, check=True, stdout=subprocess.DEVNULL)
        spent = os.times().children_user - before.children_user
        curve = curve_of(label, folder)
        yield {"label": label, "minutes": spent / 60.0, "curve": curve}


def curve_of(label: str, folder: Path) -> Curve:
    """The curve that a training has left: as a table of its own, or as monitors of its episodes."""
    if label == "fleet":
        table = pl.read_csv(folder / "fleet.csv")
        return [list(row) for row in table.select("decisions", "pta_c").iter_rows()]
    files = [*folder.glob(f"{label}.monitor.csv"), *folder.glob("monitor/*.csv")]
    rows = pl.concat([pl.read_csv(file, skip_rows=1) for file in files]).sort("t")
    ends, shares = rows["l"].cum_sum().to_numpy(), rows["pta_c"].to_numpy()
    parts = np.array_split(np.arange(len(rows)), min(POINTS, len(rows)))
    return [[float(ends[part[-1]]), float(shares[part].mean())] for part in parts]


def policies(folder: Path) -> dict[str, Any]:
    """Ours, and those that the trainings in a folder have left."""
    found: dict[str, Any] = {name: create_policy(name) for name in SHIPPED}
    made = runpy.run_path(str(folder / "fleet" / "fleet.py"))
    found["fleet"] = made["Fleet"](folder / "fleet" / "fleet.pt")
    files = {"twenty_lines": "twenty_lines/ppo", "graph": "hulls/graph", "physics": "hulls/physics"}
    for label, file in files.items():
        found[label] = policy_of_model(MaskablePPO.load(folder / f"{file}.zip"), label)()
    return found


def main(words: Sequence[str] | None = None) -> None:
    """Train, play and write."""
    parser = argparse.ArgumentParser(prog="python -m tests.mjforage.learning.tutorials")
    parser.add_argument("--episodes", type=int, default=EPISODES)
    parser.add_argument("--json", type=Path, required=True)
    chosen = parser.parse_args(words)
    with TemporaryDirectory() as temporary:
        folder, trained = Path(temporary), {}
        for page in PAGES:
            for one in train(page, folder / page):
                trained[one.pop("label")] = one
                say(f"{page}: {one['minutes']:.1f} CPU minutes, PTA_C {one['curve'][-1][1]:.1f} %")
        scores = {
            name: {
                key: played_values.tolist()
                for key, played_values in played(SCENARIO, policy, chosen.episodes).items()
                if key in ("return", "pta_c", "nt90")
            }
            for name, policy in policies(folder).items()
        }
    found = {"trained": trained, "scores": scores}
    chosen.json.write_text(json.dumps(found) + "\n", "utf-8")


if __name__ == "__main__":
    main()
