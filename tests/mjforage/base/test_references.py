from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import pytest

from mjforage.base.errors import UserError
from mjforage.base.references import Reference, bind, parse_reference


class Auction:
    def __init__(
        self,
        margin: float = 1.0,
        rounds: int = 3,
        fast: bool = False,
        mode: Literal["open", "sealed"] = "open",
        names: Sequence[str] = (),
        book: Path | None = None,
        anything: Any = None,
    ) -> None:
        pass


class Needy:
    def __init__(self, size: int) -> None:
        pass


class Open:
    def __init__(self, **options: object) -> None:
        pass


def label(text: str, made: type = Auction) -> str:
    return str(bind(made, parse_reference(text, "policy"), "policy")[0])


def values(text: str, made: type = Auction) -> dict[str, Any]:
    found: dict[str, Any] = bind(made, parse_reference(text, "policy"), "policy")[1]
    return found


@pytest.mark.parametrize(
    ("text", "name", "options"),
    [
        ("auction", "auction", {}),
        ("auction()", "auction", {}),
        (" auction ( margin = 2.5 ) ", "auction", {"margin": 2.5}),
        ("my.module:Auction(fast=true, rounds=-4)", "my.module:Auction", None),
        ('a(x=[1, 2], y="p, q(=)", z=models/ppo.zip)', "a", None),
        ("a(x=1e3,y=word)", "a", {"x": 1000.0, "y": "word"}),
    ],
)
def test_a_reference_is_read_and_its_text_reads_the_same(
    text: str, name: str, options: dict[str, Any] | None
) -> None:
    found = parse_reference(text, "policy")
    assert found.name == name
    assert options is None or found.options == options
    assert parse_reference(str(found), "policy") == found


def test_values_are_toml_and_bare_words_are_text() -> None:
    found = parse_reference('a(x=[1, 2], y="p, q(=)", z=models/ppo.zip, t="true", u=true)', "p")
    expected = {"x": [1, 2], "y": "p, q(=)", "z": "models/ppo.zip", "t": "true", "u": True}
    assert found.options == expected
    assert str(found) == 'a(t="true", u=true, x=[1, 2], y="p, q(=)", z=models/ppo.zip)'


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "expected NAME or NAME"),
        ("(margin=2)", "expected NAME or NAME"),
        ("auction(margin=2", "expected NAME or NAME"),
        ("auction(margin)", "'margin' is no OPTION=VALUE"),
        ("auction(margin=2, fast)", "'fast' is no OPTION=VALUE"),
        ("auction(margin=[1)", "is no OPTION=VALUE"),
        ("auction(margin=nan)", "is no OPTION=VALUE"),
        ("auction(margin=1, margin=2)", "option margin is given twice"),
        ("auction(margin=1\nfast=true)", "is no OPTION=VALUE"),
    ],
)
def test_what_is_no_reference_is_refused(text: str, words: str) -> None:
    with pytest.raises(UserError, match=words):
        parse_reference(text, "policy")


def test_one_policy_has_one_label() -> None:
    same = ("auction(rounds=4, margin=2)", "auction(margin=2.0, rounds=4, fast=false)")
    assert {label(text) for text in same} == {"auction(margin=2, rounds=4)"}
    assert label("auction(margin=1, mode=open)") == "auction"


def test_options_become_arguments_of_the_annotated_type() -> None:
    found = values("auction(margin=2, names=[a, b], book=sub/book.txt)".replace("a, b", '"a", "b"'))
    assert found == {"margin": 2.0, "names": ("a", "b"), "book": Path("sub/book.txt")}
    assert type(found["margin"]) is float
    assert values("auction(anything={x = 1})") == {"anything": {"x": 1}}
    assert values("open(a=1, b=two)", Open) == {"a": 1, "b": "two"}


@pytest.mark.parametrize(
    ("text", "made", "words"),
    [
        ("auction(margn=2)", Auction, "policy auction: unknown option margn; did you mean margin"),
        ("auction(margin=high)", Auction, "option margin = high: expected float"),
        ("auction(rounds=2.5)", Auction, "option rounds = 2.5: expected int"),
        (
            "auction(rounds=99999999999999999999)",
            Auction,
            r"9: expected a number within \+-92233720",
        ),
        ("auction(rounds=true)", Auction, "option rounds = true: expected int"),
        ("auction(fast=1)", Auction, "option fast = 1: expected true or false"),
        ("auction(mode=shut)", Auction, "option mode = shut: choose open, sealed"),
        ("auction(names=[1])", Auction, r"option names = \[1\]: expected str"),
        ("auction(book=3)", Auction, r"option book = 3: expected Path \| None"),
        ("needy", Needy, r"option size is missing; give needy\(size=...\)"),
        ("plain(x=1)", object, "unknown option x; it takes none"),
    ],
)
def test_an_option_that_does_not_fit_is_one_line(text: str, made: type, words: str) -> None:
    with pytest.raises(UserError, match=words) as caught:
        label(text, made)
    assert "\n" not in str(caught.value)


def test_a_reference_without_options_is_its_name() -> None:
    assert str(Reference("greedy")) == "greedy"
