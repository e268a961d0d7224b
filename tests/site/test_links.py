"""What `make links` says of links to other sites."""

import json

import pytest

from tests.site.links import BROKEN, GOOD, UNKNOWN, report

NO_NAME = "HTTPSConnectionPool(host='x.org', port=443): (Caused by NameResolutionError(...))"


def line(status: str, info: str = "", uri: str = "https://x.org") -> str:
    return json.dumps(
        {"filename": "a.md", "lineno": 3, "status": status, "code": 0, "uri": uri, "info": info}
    )


@pytest.mark.parametrize(
    ("status", "info", "word", "why"),
    [
        ("broken", "404 Client Error: Not Found", BROKEN, "404 Client Error: Not Found"),
        ("broken", "SSLError: certificate failed", BROKEN, "SSLError: certificate failed"),
        ("broken", NO_NAME, UNKNOWN, "NameResolutionError"),
        ("timeout", "", UNKNOWN, "timeout"),
        ("ignored", "service unavailable", UNKNOWN, "service unavailable"),
    ],
)
def test_what_is_not_good_is_told(status: str, info: str, word: str, why: str) -> None:
    words, good = report([line("working"), line(status, info)])
    assert good == (word == UNKNOWN), "a site of others that is down is no fault of a page"
    assert words[0] == f"a.md:3: {word}: https://x.org ({why})"
    assert f"1 {GOOD}" in words[1]
    assert f"1 {word}" in words[1]
    assert len(words) == 2


def test_good_links_and_those_inside_pass() -> None:
    inside = line("unchecked", uri="../start.md")
    words, good = report([line("working"), line("redirected", "https://y.org"), inside])
    assert good
    assert words == ["links to other sites: 2; 2 good, 0 broken, 0 not checked"]


def test_a_machine_without_a_network_does_not_pass_for_broken_links() -> None:
    words, good = report([line("broken", NO_NAME)])
    assert not good
    assert "no network" in words[-1]
