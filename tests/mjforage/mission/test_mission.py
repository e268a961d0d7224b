import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.mission import Mission
from mjforage.mission.scoring import Scorer
from mjforage.mission.setup import Setup
from mjforage.mission.task import Observation, Task
from mjforage.scenario.scenario_file import load_scenario
from tests.brief_policies import brief_policies


def setup_of(preset: str, *overrides: str) -> Setup:
    return Setup.of(load_scenario(preset, overrides))


def played(
    setup: Setup, policy: str, episodes: NDArray[np.int64], seed: int = 0
) -> tuple[Scorer, Mission]:
    mission = Mission(setup)
    mission.reset(seed, episodes)
    scorer = Scorer(mission)
    mission.run(create_policy(policy), (scorer,))
    return scorer, mission


@pytest.mark.parametrize("policy", brief_policies())
def test_logs_are_the_same_bits_whatever_the_batch(policy: str) -> None:
    setup = setup_of("comb-port", "horizon=50")
    first = 41  # so that an episode has another place in each batch, and by any small divisor
    scorer, _ = played(setup, policy, np.arange(first, 70))
    whole, scores = scorer.log, scorer.scores()
    for batch in (np.array([63]), np.arange(60, 67), np.array([66, 60])):
        scorer, _ = played(setup, policy, batch)
        part, found = scorer.log, scorer.scores()
        for name in ("agent_node", "yaw", "distance", "length", "n_items"):
            np.testing.assert_array_equal(getattr(part, name), getattr(whole, name)[batch - first])
        for name, series in found.series.items():
            np.testing.assert_array_equal(series, scores.series[name][batch - first])
        for name, values in found.scalars.items():
            np.testing.assert_array_equal(values, scores.scalars[name][batch - first])
        for name in ("t_discovered", "discovered_by", "t_collected", "collected_by", "item_start"):
            for i, place in enumerate(batch - first):
                k = part.n_items[i]
                np.testing.assert_array_equal(
                    getattr(part, name)[i, :k], getattr(whole, name)[place, :k]
                )


def test_item_worlds_do_not_depend_on_policy_or_team() -> None:
    """With nobody collecting, every item drifts the same way whoever watches."""
    tracks = []
    for policy, team in (("random", 2), ("greedy", 2), ("greedy", 5)):
        overrides = ("horizon=30", "team.foragers.count=0", f"team.scouts.count={team}")
        mission = Mission(setup_of("comb-port", *overrides))
        mission.reset(3, np.arange(6))
        mission.run(create_policy(policy))
        tracks.append(mission.state.item_rc.copy())
    np.testing.assert_array_equal(tracks[0], tracks[1])
    np.testing.assert_array_equal(tracks[0], tracks[2])


@pytest.mark.parametrize("without", ["scouts", "foragers"])
@pytest.mark.parametrize("policy", brief_policies())
def test_a_fleet_may_lack_scouts_or_foragers(policy: str, without: str) -> None:
    setup = setup_of("comb-port", f"team.{without}.count=0", "horizon=40")
    scorer, mission = played(setup, policy, np.arange(3))
    log = scorer.log
    assert (mission.state.agent_node >= 0).all()
    if without == "foragers":
        assert (log.t_collected == -1).all() and (log.length == 40).all()


@pytest.mark.parametrize("capability", ["carries", "relays"])
def test_what_a_role_can_do_and_nothing_uses_is_refused(capability: str) -> None:
    setup = setup_of("comb-port", f"team.scouts.{capability}=true")
    with pytest.raises(UserError, match=rf"team\.scouts\.{capability} = true, but no rule"):
        Mission(setup)


def test_more_agents_than_starts_take_the_nearest_free_nodes() -> None:
    setup = setup_of("comb-port", "team.scouts.count=7")
    mission = Mission(setup)
    mission.reset(0, np.arange(50))
    nodes = mission.state.agent_node
    assert all(np.unique(row).size == 9 for row in nodes)
    assert set(setup.start_nodes.tolist()) <= set(nodes[0].tolist())
    assert np.unique(nodes[:, 0]).size > 4  # who starts where is drawn per episode


class Undecided:
    """Answers with what is no number."""

    def reset(self, task: Task, keys: NDArray[np.uint64]) -> None:
        self.shape = (keys.size, len(task.fleet), 9)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        return np.full(self.shape, np.nan)


def test_a_policy_whose_preferences_are_nan_is_named() -> None:
    mission = Mission(Setup.of(load_scenario("comb-port")))
    mission.reset(0, np.arange(1))
    with pytest.raises(UserError, match="policy Undecided: gives preferences that are NaN"):
        mission.run(Undecided())


def test_networks_decide_on_the_device_of_the_hulls(monkeypatch: pytest.MonkeyPatch) -> None:
    """A policy that names a place for its networks is told it; others are not touched."""
    setup = Setup.of(load_scenario("comb-port", ("horizon=2", "physics.device=cuda")))
    mission, policy, other = Mission(setup), create_policy("random"), create_policy("random")
    mission.reset(0, np.arange(1))
    for wanted in ("cpu", "cuda"):
        policy.network_device = "?"  # type: ignore[attr-defined]
        for one in (policy, other):
            mission.prepare(one)
        assert policy.network_device == wanted  # type: ignore[attr-defined]
        monkeypatch.setattr(type(mission._dynamics), "network_device", "cuda", raising=False)
    assert not hasattr(other, "network_device")
