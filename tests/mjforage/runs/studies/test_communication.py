"""The variants of the study of communication."""

from dataclasses import replace

import numpy as np
import pytest

from mjforage.mission.link.reach import reach_m
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.runs.studies.communication import AXES, RELAY, communication
from mjforage.runs.studies.study import Variant
from mjforage.scenario.link import Link
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import (
    canonical_json,
    load_scenario,
    scenario_from_tree,
    scenario_to_tree,
)

POLICIES = ("greedy", "belief")


def named(scenario: Scenario) -> dict[str, Variant]:
    found = communication(scenario, POLICIES)
    assert len({variant.name for variant in found}) == len(found), "two variants of one name"
    assert all(variant.policies == POLICIES for variant in found)
    return {variant.name: variant for variant in found}


@pytest.fixture(scope="module")
def found() -> dict[str, Variant]:
    return named(load_scenario("comb-port"))


def test_every_limit_of_the_specification_is_a_link_of_its_own(found: dict[str, Variant]) -> None:
    disk = Link("disk")
    links = {"complete": Link(), "none": Link("none")}
    links |= {f"range-{r}": replace(disk, range_m=float(r)) for r in (16, 32, 64, 128)}
    links |= {
        f"range-{r}-quays": replace(disk, range_m=float(r), wall_db=1.0) for r in (16, 32, 64, 128)
    }
    links["range-inf-quays"] = replace(disk, wall_db=1.0)
    links |= {f"latency-{n}": replace(disk, latency=n) for n in (1, 3, 10)}
    links |= {f"loss-{q}": replace(disk, loss=q) for q in (0.3, 0.6, 0.9)}
    links |= {f"loss-{q}-burst-10": replace(disk, loss=q, burst=10.0) for q in (0.3, 0.6, 0.9)}
    links |= {f"bytes-{n}": replace(disk, bytes=n) for n in (12, 20, 32, 51)}
    assert {n: v.scenario.link for n, v in found.items() if not n.startswith("relay")} == links
    plain = load_scenario("comb-port")
    assert all(replace(found[n].scenario, link=Link()) == plain for n in links)


def test_no_scenario_is_played_twice_and_each_can_be_written_down(
    found: dict[str, Variant],
) -> None:
    texts = {canonical_json(scenario_to_tree(one.scenario)) for one in found.values()}
    assert len(texts) == len(found) == 28
    for one in found.values():
        tree = scenario_to_tree(one.scenario)
        again = scenario_from_tree(tree, one.name)
        assert again == one.scenario
        assert canonical_json(scenario_to_tree(again)) == canonical_json(tree), "types differ"


def test_only_what_passes_on_differs_between_relays(found: dict[str, Variant]) -> None:
    relays = {name: one.scenario for name, one in found.items() if name.startswith("relay")}
    told = {
        name: (one.link.relay, one.team[RELAY].relays, one.team[RELAY].antenna_m)
        for name, one in relays.items()
    }
    assert told == {
        "relay-nobody": (False, False, 0.25),
        "relay-low": (False, True, 0.25),
        "relay-mast": (False, True, 5.0),
        "relay-all": (True, False, 0.25),
    }
    for one in relays.values():
        assert [role.antenna_m for role in one.team.values()][:2] == [0.25, 0.25]
        same = replace(one.team[RELAY], relays=False, antenna_m=0.25)
        alike = replace(one, team={**one.team, RELAY: same}, link=replace(one.link, relay=False))
        assert alike == relays["relay-nobody"]


def test_the_relays_mast_reaches_four_times_as_far_as_boats(found: dict[str, Variant]) -> None:
    """By hand, beyond 4 pi h h' / lambda: 40 log d - 20 log (h h'), of 90 dB less some 4 dB."""
    link = found["relay-mast"].scenario.link
    boats, mast = (reach_m(link, np.array([0.25, height])) for height in (0.25, 5.0))
    assert boats == pytest.approx(10 ** ((86.2 + 40 * np.log10(0.25)) / 40), rel=0.03)
    assert mast == pytest.approx(10 ** ((86.2 + 20 * np.log10(0.25 * 5.0)) / 40), rel=0.03)
    assert (round(boats), round(mast)) == (36, 157)


def test_the_relay_stays_at_a_start_and_sees_its_own_node(found: dict[str, Variant]) -> None:
    setup = Setup.of(found["relay-mast"].scenario)
    mission = create_mission(setup, "graph")
    mission.reset(0, np.arange(3, dtype=np.int64))
    begun, relay = mission.state.agent_node.copy(), len(setup.fleet) - 1
    wishes = np.random.default_rng(0)
    for _ in range(5):
        mission.advance(wishes.uniform(size=(3, len(setup.fleet), 9)))
    assert (mission.state.agent_node[:, relay] == begun[:, relay]).all()
    assert (mission.state.agent_node[:, :relay] != begun[:, :relay]).any()
    seen = mission.times_seen(np.array([relay]), np.arange(3, dtype=np.int64))
    assert seen.sum(axis=1).tolist() == [1, 1, 1]


def test_a_scenario_with_a_link_is_played_as_it_is_too() -> None:
    own = load_scenario(
        "comb-port",
        ["link.model=disk", "link.range_m=64", "team.scouts.relays=true", "link.loss=0.1"],
    )
    found = named(own)
    assert found["own"].scenario == own
    assert found["complete"].scenario.link == Link()
    assert not found["complete"].scenario.team["scouts"].relays, "nothing to relay"
    assert found["latency-3"].scenario.link == Link("disk", latency=3)


def test_a_given_order_of_teams_takes_the_relay_in() -> None:
    scenario = load_scenario("comb-port", ['rules.order=["scouts", "foragers"]'])
    found = named(scenario)
    assert found["relay-low"].scenario.rules.order == ("scouts", "foragers", RELAY)
    assert found["range-16"].scenario.rules.order == ("scouts", "foragers")


def test_lines_ascend_and_hold_the_ideal_link_where_it_is_a_limit() -> None:
    with_ideal = set()
    for axis in AXES:
        for line, points in axis.lines.items():
            values = [point.value for point in points]
            assert values == sorted(set(values)), (axis.name, line)
            if "complete" in [point.variant for point in points]:
                with_ideal.add((axis.name, line))
    assert with_ideal == {
        ("range", "no walls"),
        ("latency", ""),
        ("loss", "independent"),
        ("loss", "bursts of 10"),
        ("bytes", ""),
    }
