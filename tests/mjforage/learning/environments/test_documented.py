"""The tables of docs/learning.md against what an environment gives."""

import re
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

PAGE = Path(__file__).parents[4] / "docs" / "learning.md"
ROW = re.compile(r"^\|(?P<array>[^|]*)\| *(?P<entries>\d[\d, ]*)\|", re.MULTILINE)
ENTRIES_ON_AXIS = {"map": 0, "crop": 0, "globe": 0, "moves": 1, "own": 0}


def shared(kind: str, **options: Any) -> gymnasium.Env[Any, Any]:
    return gymnasium.make("mjforage/SharedPolicy-v0", observation=kind, **options)


def test_every_entry_has_a_row() -> None:
    text = PAGE.read_text("utf-8")
    described: dict[str, list[int]] = {}
    array = ""
    section = text[text.index("| array | entry |") :].partition("\n## ")[0]
    for row in ROW.finditer(section):
        array = row["array"].strip(" `") or array
        described.setdefault(array, []).extend(int(i) for i in row["entries"].split(","))
    shapes = {
        name: box.shape
        for kind in ("paper", "egocentric")
        for name, box in shared(kind).observation_space.spaces.items()  # type: ignore[attr-defined]
        if name != "action_mask"
    }
    sizes = {name: shapes[name][axis] for name, axis in ENTRIES_ON_AXIS.items()}
    assert shapes.keys() == sizes.keys()
    assert {name: sorted(rows) for name, rows in described.items()} == {
        name: list(range(size)) for name, size in sizes.items()
    }


def test_numbers_of_its_own_are_as_documented() -> None:
    options = ("horizon=20", "team.scouts.count=3", "team.foragers.energy=10")
    env: Any = shared("egocentric", set=options)
    observation, info = env.reset(seed=0)
    for turn in range(10):
        core = env.unwrapped.core
        seen, task = core.mission.observation, core.setup.task
        agent, own = info["agent"], observation["own"]
        expected = {
            0: float(agent >= 3),
            1: (turn // 5) / 20,
            2: seen.n_known[0] / 127.5,
            4: seen.energy_left[0, agent] / 10 if agent >= 3 else 1.0,
            5: (agent - 3) / 2 if agent >= 3 else agent / 3,
            8: (2 if agent >= 3 else 3) * 32 / 255,
            9: (3 if agent >= 3 else 2) * 32 / 255,
            10: task.arrays.moves[agent] * 32 / 255,
            11: task.fleet.radius[agent] * 16 / 255,
        }
        for entry, value in expected.items():
            assert own[entry] == pytest.approx(min(1.0, value), abs=1 / 255), entry
        legal = int(np.flatnonzero(observation["action_mask"])[0])
        observation, *_, info = env.step(legal)
