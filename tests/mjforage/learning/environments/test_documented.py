"""The tables of docs/learning/environments.md against what an environment gives."""

import re
from pathlib import Path
from typing import Any

import gymnasium

PAGE = Path(__file__).parents[4] / "docs" / "learning" / "environments.md"
ROW = re.compile(r"^\|(?P<array>[^|]*)\| *(?P<entries>\d[\d, ]*)\|", re.MULTILINE)
ENTRIES_ON_AXIS = {"map": 0, "local_map": 0, "global_map": 0, "moves": 1, "own": 0}


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
