"""What policies are told of the items stands in one place and on the pages that compare them."""

import re

from mjforage.graph_planner.policies.registry import policy_names, policy_told
from mjforage.view.page.table import NOTHING
from tests.evidence.piece import REPOSITORY, load, pieces


def test_planners_and_bounds_are_told_and_others_are_not() -> None:
    assert policy_told("belief(robust=true)") == policy_told("dec-mcts") == "their law"
    assert policy_told("oracle") == "the items"
    assert policy_told("auction") == policy_told("nobody") == ""


def test_the_page_of_policies_says_what_they_are_told() -> None:
    page = (REPOSITORY / "docs/policies/index.md").read_text("utf-8")
    table = page.partition("| told of items |")[2].partition("\n\n")[0]
    rows = re.findall(r"^\| (`.*?) \| (.*?) \|", table, re.M)
    found = {name: told for names, told in rows for name in re.findall(r"`(.*?)`", names)}
    assert found == {name: policy_told(name) or NOTHING for name in policy_names()}


def test_tables_of_evidence_say_what_policies_are_told() -> None:
    told = []
    for piece in map(load, pieces()):
        at = [i for i, column in enumerate(piece.columns) if column.head == "told of items"]
        told += [(row.of["policy"], row.cells[i]) for i in at for row in piece.rows if row.cells[i]]
    assert told
    assert {(name, policy_told(name) or NOTHING) for name, _ in told} == set(told)
