"""Several values behind one flag."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mjforage.cli.words import several
from tests.mjforage.cli.short_runs import Refused

pytestmark = pytest.mark.usefixtures("here")


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ("evaluate --policy greedy levy -o x", "evaluate --policy greedy --policy levy -o x"),
        ("evaluate --policy greedy open-bay", "evaluate --policy greedy open-bay"),
        ("evaluate --policy a b open-bay", "evaluate --policy a --policy b open-bay"),
        ("compare --policy a b my.toml", "compare --policy a --policy b my.toml"),
        ("study board --policy a comb_port@physics", "study board --policy a comb_port@physics"),
        ("evaluate --replay 0 3 worst --seed 1", "evaluate --replay 0,3,worst --seed 1"),
        ("evaluate --policy --seed 1", "evaluate --policy --seed 1"),
        ("evaluate --policy", "evaluate --policy"),
        ("report run --figures pdf png", "report run --figures pdf,png"),
        ("report --tables csv latex . ", "report --tables csv,latex ."),
        ("render --policy greedy run", "render --policy greedy run"),
        ("", ""),
    ],
)
def test_what_follows_a_flag_belongs_to_it_unless_it_is_another_argument(
    given: str, meant: str
) -> None:
    assert several(given.split()) == meant.split()


def test_policies_and_figures_are_taken(
    command: Callable[..., Any], finished: Path, refused: Refused
) -> None:
    assert "policy gredy: unknown; did you mean greedy?" in refused(
        "evaluate", "--policy", "levy", "gredy"
    )
    assert "jpeg" in refused("report", finished, "--figures", "pdf", "jpeg")
