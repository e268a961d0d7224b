"""Small cases of the tables of coverage and of equals."""

from tests.evidence import coverage, equals
from tests.evidence.equals import shares


def test_intervals_of_a_small_pool_cover() -> None:
    """PTA_C, NT90 and below 90 of greedy: 800 episodes against others; its means are uncertain."""
    rows = coverage.table({"greedy": (((1, 800),), ((4, 800),))}, samples=300)
    found = {name: row for name, *row in rows}
    for name in ("PTA C", "NT 90", "Below 90", "RMSE"):
        assert len(found[name]) == 3 and min(found[name]) >= 0.88, name
    assert "Energy (rough)" in found and "Handover" not in found


def test_equals_are_bold_in_most_of_some_tables() -> None:
    """Of 20 tables of five streams one at most is expected to have a policy that is not bold."""
    found = shares(policies=5, tables=20, size=20)
    assert list(found) == list(equals.KEYS)
    assert min(found.values()) >= 0.8
    first, other = (equals.episodes(number, 4)["pta_c"].to_list() for number in (0, 1))
    assert first != other, "streams of their own"
