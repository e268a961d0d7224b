"""A third role and owners who do not receive everything, added here alone: no package is edited."""

from collections.abc import Sequence
from typing import Any, Self

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.randomness import UInt64Array
from mjforage.base.rows import scatter_all
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.exchange import Exchange
from mjforage.mission.knowledge import Knowledge, Scans, receive
from mjforage.mission.mission import Mission
from mjforage.mission.scoring import Scorer
from mjforage.mission.setup import Setup
from mjforage.mission.task import Task, no_delayed_scans
from mjforage.scenario.scenario_file import load_scenario, scenario_from_tree, scenario_to_tree

SWEEPERS = {"count": 2, "moves": 1, "radius": 3.0, "collects": True, "capacity": 4}
RELAYS = {"count": 1, "moves": 1, "radius": 0.0, "collects": False, "relays": True}
CARRYING = 12.0  # geodesic distance that the link of these tests bridges [node]


class Groups:
    """Owners that receive the scans of their own agents only, or of some others too, at once."""

    uses: frozenset[str] = frozenset()
    link_log = None

    def __init__(self, owner_of: Sequence[int], receives: Sequence[Sequence[int]]) -> None:
        """Prepare: `receives` is 1 where an owner (owner, agent) receives an agent's scans."""
        self.owner_of = np.array(owner_of, np.int64)
        self._hears = np.array(receives, np.bool_)
        self.owners = len(self._hears)

    def reset(self, task: Task, scans: Scans, pooled: Knowledge, keys: UInt64Array) -> None:
        self._task = task
        self.delayed = no_delayed_scans(scans.step.size * self.owners)
        self.knowledge = Knowledge.of_starts(scans, len(task.graph), self.owners)
        self.update(scans, pooled)

    def update(self, scans: Scans, pooled: Knowledge) -> None:
        task = self._task
        receive(scans, self.received(scans), task.views, task.radius_number, self.knowledge)

    def received(self, scans: Scans) -> NDArray[np.bool_]:
        return np.tile(self._hears, (scans.step.size, 1))

    def replace_episodes(self, rows: NDArray[np.int64], other: Self, pooled: Knowledge) -> None:
        own = (rows[:, None] * self.owners + np.arange(self.owners)).reshape(-1)
        self.knowledge = scatter_all(self.knowledge, own, other.knowledge)


class Relayed(Groups):
    """Foragers receive scouts only while a relay is near enough to one of them."""

    uses = frozenset({"relays"})

    def received(self, scans: Scans) -> NDArray[np.bool_]:
        fleet, at = self._task.fleet, scans.agent_node
        relays, listeners = np.flatnonzero(fleet.relays), fleet.collectors
        distances = self._task.graph.distances[at[:, relays, None], at[:, None, listeners]]
        near = distances.min(axis=(1, 2)) <= CARRYING
        received = super().received(scans).reshape(scans.step.size, self.owners, len(fleet))
        received[:, 1, fleet.discoverers] &= near.reshape(-1, 1)
        return received.reshape(-1, len(fleet))


def setup_of(team: dict[str, Any], *overrides: str, order: Sequence[str] = ()) -> Setup:
    """The default mission with more teams."""
    tree = scenario_to_tree(load_scenario("comb-port", ["horizon=40", *overrides]))
    tree["team"] |= team
    tree["rules"]["order"] = list(order)
    return Setup.of(scenario_from_tree(tree, "seam"))


def played(setup: Setup, policy: str, exchange: Exchange | None = None) -> Scorer:
    mission = Mission(setup, exchange=exchange)
    mission.reset(5, np.arange(3))
    scorer = Scorer(mission)
    mission.run(create_policy(policy), (scorer,))
    return scorer


@pytest.mark.parametrize("policy", ["belief", "greedy", "ddqn"])
def test_a_third_role_is_a_row_in_a_scenario(policy: str) -> None:
    """Sweepers see farther than foragers and hold little: planned for, obeyed and scored."""
    setup = setup_of({"sweepers": SWEEPERS}, "items.mean=150")
    assert setup.fleet.names[4:] == ("sweepers_0", "sweepers_1")
    assert setup.fleet.order.tolist() == [3, 2, 5, 4, 1, 0]
    scorer = played(setup, policy)
    log = scorer.log
    taken = np.stack([(log.collected_by == agent).sum(axis=1) for agent in range(6)], axis=1)
    assert (taken[:, :2] == 0).all(), "scouts collect nothing"
    assert (taken[:, 4:] <= 4).all(), "and sweepers no more than they can hold"
    assert taken[:, 4:].sum() > 0
    scores = scorer.scores().scalars
    some = taken.sum(axis=1) > 0  # inequality and share of nothing are undefined
    assert np.isfinite(scores["gini_foragers"][some]).all()
    assert np.isfinite(scores["csr"][some]).all() and some.any()


def test_a_relay_is_a_role_and_a_way_to_hear() -> None:
    setup = setup_of({"relays": RELAYS})
    with pytest.raises(UserError, match=r"team\.relays\.relays = true, but no rule"):
        Mission(setup)
    receives = [[1, 1, 0, 0, 1], [1, 1, 1, 1, 1]]
    exchange = Relayed([0, 0, 1, 1, 0], receives)
    mission = Mission(setup, exchange=exchange)
    mission.reset(5, np.arange(20))
    mission.run(create_policy("wanderer"))
    age = mission.step[:, None] - exchange.knowledge.agent_seen.reshape(20, 2, 5)[:, 1, :2]
    assert (age == 0).any() and (age > 0).any(), "some foragers receive the scouts at the end"
    assert (age[:, 0] == age[:, 1]).all()
