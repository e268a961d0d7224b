"""docs/gallery.md: its films are small, move, and stand beside the commands that make them."""

import re
import shlex

import pytest
from PIL import Image

from tests.documents.blocks import REPOSITORY, blocks

PAGE = "docs/gallery.md"
TEXT = (REPOSITORY / PAGE).read_text("utf-8")
FOLDER = REPOSITORY / "docs" / "gallery"
FILMS = sorted(path.name for path in FOLDER.iterdir())
LARGEST_BYTES = 1_000_000  # of a film
SHOWN = re.findall(r"!\[([^\]]+)\]\(gallery/([\w-]+\.gif)\)", TEXT)


def test_each_film_is_shown_once_and_in_words() -> None:
    assert sorted(name for _, name in SHOWN) == FILMS
    assert all(len(words) > 40 for words, _ in SHOWN)


@pytest.mark.parametrize("name", FILMS)
def test_a_film_is_small_and_loops(name: str) -> None:
    path = FOLDER / name
    assert path.stat().st_size < LARGEST_BYTES
    with Image.open(path) as film:
        assert (film.format, film.info["loop"]) == ("GIF", 0)
        assert getattr(film, "n_frames", 1) >= 20


@pytest.mark.parametrize("name", FILMS)
def test_the_command_of_a_film_follows_it(name: str) -> None:
    line = TEXT[: TEXT.index(f"(gallery/{name})")].count("\n") + 1
    block = next(one for one in blocks(PAGE) if one.line > line)
    assert block.language == "sh" and block.long
    *_, command = (shlex.split(words) for words in block.text.splitlines())
    assert command[:2] == ["mjforage", "render"]
    assert command[command.index("-o") + 1] == name
