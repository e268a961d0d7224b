"""Inside the thrust envelope every move arrives; outside, the log says so."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.graph_planner.policies import create_policy
from mjforage.mission.dynamics import ARRIVED, LATE
from mjforage.mission.episode_log import EpisodeLog
from mjforage.mission.setup import Setup
from mjforage.physics.dynamics.mujoco_dynamics import MujocoDynamics
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario_file import load_scenario

PERIODS = 4
TEAMS = ("scouts", "foragers")
Nearest = NDArray[np.float64]  # (episode, decision, agent) [m] midships to target


def random_moves(
    sea: str, team: str, current_mps: float, period_s: float, episodes: int
) -> tuple[EpisodeLog, Nearest]:
    """Random decisions of a vessel alone on open water, and how near it came to its targets."""
    counts = (f"team.{name}.count={int(name == team)}" for name in TEAMS)
    current = f"weather.current_speed_mps={current_mps}"
    overrides = (*counts, current, f"period_s={period_s}", f"horizon={PERIODS}", "items.mean=5")
    setup = Setup.of(load_scenario("open-bay", overrides, sea))
    mission = create_mission(setup, "physics")
    mission.reset(5, np.arange(episodes))
    dynamics = mission._dynamics
    assert isinstance(dynamics, MujocoDynamics)
    nearest = np.full((episodes, PERIODS + 1, 1), np.inf)
    ticks: Any = dynamics._playing
    inner = ticks._steer

    def steer(active: Any, ids: Any, target: NDArray[np.float64], known: Any) -> None:
        inner(active, ids, target, known)
        off = np.hypot(*np.moveaxis(dynamics._simulation.vessel_pose[..., :2] - target, -1, 0))
        now = (ids, mission.step[ids])
        nearest[now] = np.minimum(nearest[now], off[ids])

    ticks._steer = steer
    log = EpisodeLog(mission)
    mission.run(create_policy("random"), (log,))
    made = np.arange(PERIODS + 1)[None, :] <= log.length[:, None]
    nearest[~made] = np.nan
    return log, nearest


@pytest.fixture(scope="module")
def sea(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A map of water only, where a current is the same everywhere."""
    file = tmp_path_factory.mktemp("maps") / "sea.csv"
    np.savetxt(file, np.ones((48, 64), int), "%d", ",")
    return str(file)


@pytest.mark.parametrize("team", TEAMS)
@pytest.mark.parametrize(
    ("current_mps", "period_s", "share"), [(0.0, 10.0, 1.0), (0.3, 20.0, 0.995)]
)
def test_moves_of_200_seeds_arrive(
    sea: str, team: str, current_mps: float, period_s: float, share: float
) -> None:
    """One and two nodes, straight and diagonal, in the wind that drifts the items: every one.

    Stemming a current takes more than the usual 10 s.
    """
    log, nearest = random_moves(sea, team, current_mps, period_s, 200)
    made = np.isfinite(nearest)
    assert made.sum() > 700
    assert set(log.direction[made]) == set(range(9))
    assert (log.outcome[made] == ARRIVED).mean() >= share
    assert ((log.outcome == ARRIVED) == (nearest <= 1.0))[made].all()


@pytest.mark.parametrize("team", TEAMS)
@pytest.mark.parametrize("current_mps", [0.3, 1.0, 2.0])
def test_who_does_not_arrive_is_never_silent(sea: str, team: str, current_mps: float) -> None:
    """In a current, in a decision of 10 s; the strongest is more than any hull stems."""
    log, nearest = random_moves(sea, team, current_mps, 10.0, 40)
    made = np.isfinite(nearest)
    assert ((log.outcome == ARRIVED) == (nearest <= 1.0))[made].all()
    late = (log.outcome[made] == LATE).mean()
    assert late > 0.5 if current_mps == 2.0 else 0.0 < late < 0.7
