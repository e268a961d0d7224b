"""The picture in CONTRIBUTING.md is of today's layers, and what the page names is there."""

import re

from tests.layers.__main__ import PAGE, REPOSITORY, layers, renewed

TEXT = PAGE.read_text("utf-8")


def test_the_picture_is_of_today() -> None:
    assert renewed(TEXT) == TEXT, "python -m tests.layers draws it again"


def test_every_package_of_ours_is_in_a_layer() -> None:
    named = [name for layer in layers() for name in layer]
    top = {path.parent for path in (REPOSITORY / "mjforage").glob("*/__init__.py")}
    planner = REPOSITORY / "mjforage" / "graph_planner"
    packages = top - {planner} | {path.parent for path in planner.glob("*/__init__.py")}
    assert sorted(named) == sorted(str(path.relative_to(REPOSITORY)) for path in packages)


def test_what_it_names_is_there() -> None:
    makefile = (REPOSITORY / "Makefile").read_text("utf-8")
    for target in re.findall(r"`make ([\w-]+)", TEXT):
        assert re.search(rf"^{target}:", makefile, re.M), target
    for path in re.findall(r"`((?:tests|mjforage|metrics|graph_planner|models)/[\w./-]+)`", TEXT):
        assert (REPOSITORY / path).exists(), path
