"""README.md stays short, and its table has the numbers of docs/concepts/worlds.md."""

import re
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
README = (REPOSITORY / "README.md").read_text("utf-8")
WORLDS = (REPOSITORY / "docs" / "concepts" / "worlds.md").read_text("utf-8")
PTA_C, NT90 = 1, 3  # among the numbers of a row of worlds.md
MOST_LINES = 120


def rows(text: str) -> list[list[str]]:
    """The cells of the first table with PTA_C, without its head."""
    table = next(t for t in re.findall(r"(?:^\|.*\|\n)+", text, re.MULTILINE) if "PTA_C" in t)
    lines = table.splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_it_is_short() -> None:
    assert len(README.splitlines()) <= MOST_LINES


def test_its_table_is_that_of_the_page_on_worlds() -> None:
    command = re.findall(r"^mjforage compare .* --ladder .*$", README, re.MULTILINE)
    assert len(command) == 1 and command[0] in WORLDS
    told = rows(WORLDS)
    graph = {row[0]: row[2:] for row in told if row[1] == "graph"}
    physics = [row[2:] for row in told if row[1] == "physics − graph"]
    assert rows(README) == [
        [name, own[PTA_C], gap[PTA_C], own[NT90], gap[NT90]]
        for (name, own), gap in zip(graph.items(), physics, strict=True)
    ]
