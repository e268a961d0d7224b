"""Marginal contributions of a study whose means are known: two worlds, two policies."""

import pytest

from mjforage.view.page.style import policy_colour
from mjforage.view.report.studies import ablation
from mjforage.view.report.studies.study_logs import StudyLogs
from tests.mjforage.view.report.known_data import Means, episodes_of, known_study, told

POLICIES = ("greedy", "auction")
WORTH = {  # team, world, policy -> contribution to PTA_C and to NT90
    ("scouts", "graph", "greedy"): (0.25, 0.5),
    ("scouts", "graph", "auction"): (0.125, 0.25),
    ("scouts", "hulls", "greedy"): (0.5, 0.125),
    ("scouts", "hulls", "auction"): (-0.25, 0.75),
    ("foragers", "graph", "greedy"): (0.375, -1.0),
    ("foragers", "graph", "auction"): (0.0, 0.0),
    ("foragers", "hulls", "greedy"): (0.0625, 0.375),
    ("foragers", "hulls", "auction"): (0.75, 0.625),
}


def means(team: str) -> Means:
    """Of the whole fleet PTA_C is 80 and NT90 .5: a benefit is C less without, a cost 1/(1-C)."""
    found = {}
    for world in ("graph", "hulls"):
        for policy in POLICIES:
            gain, saved = WORTH[team, world, policy] if team else (0.0, 0.0)
            pta = (1 - gain) * episodes_of("pta_c", 80.0)
            nt = episodes_of("nt90", 0.5) / (1 - saved)
            found[world, policy] = {"pta_c": pta.tolist(), "nt90": nt.tolist()}
    return found


@pytest.fixture(scope="module")
def study() -> StudyLogs:
    variants = {"complete": means(""), "scouts-less": means("scouts")}
    return known_study(variants | {"foragers-less": means("foragers")}, scenario="published")


def test_a_benefit_is_lost_and_a_cost_is_risen_without_an_agent(study: StudyLogs) -> None:
    table = ablation.contributions_table(study, "t", "T", ("pta_c", "nt90"))
    assert table.better == (1, 1), "more of a contribution is better whatever the metric"
    ours = [row for row in table.rows if not row.paper]
    found = {(row.group.split()[-1], *row.head.split(" · ")[::-1]): row for row in ours}
    assert {key: len(row.values) for key, row in found.items()} == dict.fromkeys(WORTH, 2)
    for key, worth in WORTH.items():
        for number, expected in zip(found[key].values, worth, strict=True):
            assert number == pytest.approx((expected,) * 3, abs=1e-12), key
        assert found[key].best == {place for place in (0, 1) if worth[place]}, key
        assert found[key].colour == policy_colour(key[2])
    assert found["scouts", "hulls", "auction"].cells[0].startswith("−0.25"), "better without"


def test_papers_contributions_are_of_their_team_and_stand_below_their_like(
    study: StudyLogs,
) -> None:
    """Its Table 6: greedy without a scout .1623 of PTA_C, without a forager .0337."""
    table = ablation.contributions_table(study, "t", "T", ablation.IN_PAPER)
    paper = {row.group: (row.head, row.cells) for row in table.rows if row.paper}
    name = "Greedy, paper (its own map)"
    assert paper == {
        "one agent of scouts": (name, ("0.1090", "0.1623", "0.8692", "–")),
        "one agent of foragers": (name, ("0.0015", "0.0337", "0.4138", "–")),
    }
    heads = [row.head for row in table.rows][:5]
    assert heads == ["greedy · graph", "greedy · hulls", name, "auction · graph", "auction · hulls"]


def test_fleets_stand_with_their_own_means(study: StudyLogs) -> None:
    """Greedy in the graph: 80; without a scout three quarters of it."""
    table = ablation.setups_table(study)
    pta, nt = (table.columns.index(one) for one in ("PTA_C", "NT_90"))
    assert (table.better[pta], table.better[nt]) == (1, -1)
    found = {(row.group, row.head): row for row in table.rows if not row.paper}
    assert found["greedy", "is complete · graph"].cells[pta] == told("pta_c", 80.0)
    assert found["greedy", "is scouts-less · graph"].cells[pta] == told("pta_c", 80.0, 0.75)
    assert found["greedy", "is scouts-less · hulls"].cells[pta] == told("pta_c", 80.0, 0.5)
    assert found["greedy", "is foragers-less · graph"].cells[pta] == told("pta_c", 80.0, 0.625)
    assert found["greedy", "is scouts-less · hulls"].cells[nt] == told("nt90", 0.5, 8 / 7)
    assert found["greedy", "is foragers-less · graph"].cells[nt] == told("nt90", 0.5, 0.5)
    assert found["auction", "is scouts-less · hulls"].cells[pta] == told("pta_c", 80.0, 1.25)
    also = found["greedy", "is complete · graph"].also
    assert also[nt] == "12.5 min", "half of 150 steps of 10 s"
    papers = [(row.group, row.cells[pta]) for row in table.rows if row.paper]
    assert papers == [("greedy", "98.20"), ("greedy", "82.26"), ("greedy", "94.89")]
