"""Sizes that cannot be served are refused before the work, with what would be needed."""

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mjforage.base.errors import UserError
from mjforage.learning.training.hyperparameters import Hyperparameters, changed
from mjforage.learning.training.replay_memory import ReplayMemory, memory_bytes
from mjforage.learning.training.trainer import Trainer
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.runs.evaluate import Run
from mjforage.scenario import sizes
from mjforage.scenario.scenario_file import load_scenario

GB = 10**9


@pytest.fixture(autouse=True)
def machine(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let every machine have 16 GB."""
    monkeypatch.setattr(sizes, "machine_bytes", lambda: 16 * GB)


def setup(*overrides: str, map_file: str | None = None) -> Setup:
    return Setup.of(load_scenario("comb-port", overrides, map_file))


def test_the_largest_radius_is_served_on_a_small_map() -> None:
    """What lies beyond the map plays no part, so that 1000 nodes see as far as 100."""
    far, near = (setup(f"team.scouts.radius={radius}").task.views for radius in (1000, 100))
    assert np.array_equal(far.start, near.start)
    assert np.array_equal(far.nodes, near.nodes)


def test_a_map_that_is_too_large_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "sea.png"
    Image.new("1", (6000, 6000), 1).save(path)
    with pytest.raises(UserError, match=r"map sea.png \(6000 x 6000\), .* about \d\d GB of memory"):
        setup("map.starts=[]", map_file=str(path))


@pytest.mark.parametrize(
    ("overrides", "episodes"),
    [
        (("horizon=30000", "team.scouts.count=250"), 25),
        ((), 10**9),
        ((), 10**400),
    ],
)
def test_runs_that_are_too_large_are_refused(
    overrides: tuple[str, ...], episodes: int, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match=r"needs about .* GB of memory, this machine has 16 GB; "):
        Run.plan(setup(*overrides), ["greedy"], tmp_path / "run", episodes=episodes)
    assert list(tmp_path.iterdir()) == []


def test_a_replay_that_is_too_large_is_refused() -> None:
    chosen = changed(Hyperparameters(), {"capacity": 10_000_000, "num_envs": 4096})
    with pytest.raises(UserError) as caught:
        Trainer([load_scenario("comb-port")], chosen)
    words = "capacity = 10000000 for each team, with num_envs = 4096, needs about"
    assert re.search(rf"learning settings: a replay of {words} \d+ GB", str(caught.value))


def test_the_memory_of_a_replay_is_what_its_arrays_take() -> None:
    shapes = {"map": (3, 5, 5), "moves": (9, 4)}
    memory = ReplayMemory(shapes, 6, 1000, 3, 0.9)
    levels = sum(level.nbytes for level in memory.levels.values())
    arrays: list[np.ndarray] = [memory.legal, memory.moves, memory.demonstrated]
    arrays += [memory.rewards, memory.kind, memory.tree]
    found = levels + sum(array.nbytes for array in arrays)
    assert found == memory_bytes(shapes, 6, 1000, 3)


def test_the_estimate_covers_a_batch_and_is_not_ten_times_too_large() -> None:
    """Arrays of a mission that is logged, against the estimate for it."""
    from mjforage.mission.scoring import Scorer

    chosen, episodes = setup("horizon=100", "team.scouts.count=20"), 10
    mission = Mission(chosen)
    scorer = Scorer(mission)
    mission.reset(0, np.arange(episodes))
    scorer.see(mission)
    log = sum(v.nbytes for v in vars(scorer.log).values() if isinstance(v, np.ndarray))
    about = chosen.scenario, chosen.graph.shape, len(chosen.graph)
    estimate = sizes.mission_bytes(*about, episodes, recorded=False)
    assert log < estimate < 10 * log
