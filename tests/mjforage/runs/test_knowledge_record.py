"""Knowledge of each agent, as recorded with an episode over a link."""

from pathlib import Path

import numpy as np
import pytest

from mjforage.base.atomic_files import write_bytes
from mjforage.base.errors import UserError
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.link import Radio
from mjforage.mission.mission import Mission, Observer
from mjforage.mission.setup import Setup
from mjforage.mission.task import NEVER
from mjforage.runs.episode_recording import Recording
from mjforage.runs.knowledge_record import UNKNOWN, KnowledgeRecord, KnowledgeRecorder
from mjforage.runs.recording import record
from mjforage.scenario.scenario_file import load_scenario

LINK = ("link.model=disk", "link.range_m=40", "link.wall_db=1", "link.loss=0.5", "link.latency=1")
STEPS = 40


class Kept(Observer):
    """Knowledge of all owners, copied whole after every step."""

    def __init__(self) -> None:
        self.belief: list[np.ndarray] = []
        self.seen: list[np.ndarray] = []

    def see(self, mission: Mission) -> None:
        knowledge = mission.exchange.knowledge
        self.belief.append(knowledge.belief.copy())
        self.seen.append(knowledge.last_seen.copy())


def setup_of(*keys: str) -> Setup:
    return Setup.of(load_scenario("comb-port", [f"horizon={STEPS}", *keys]))


@pytest.fixture(scope="module")
def replay() -> Recording:
    return record(setup_of(*LINK), "graph", "greedy", 3, 0)


def held_of(replay: Recording) -> KnowledgeRecord:
    assert replay.knowledge is not None
    return replay.knowledge


def test_maps_are_what_holders_knew_after_every_step(replay: Recording) -> None:
    setup = setup_of(*LINK)
    mission, kept = Mission(setup), Kept()
    mission.reset(3, np.arange(1))
    mission.run(create_policy("greedy"), (kept,))
    held, water, differ = held_of(replay), replay.navigable.ravel(), 0
    for agent in range(4):
        belief, seen = held.maps(agent, water.size)
        np.testing.assert_array_equal(belief[:, water], [each[agent] for each in kept.belief])
        np.testing.assert_array_equal(seen[:, water], [each[agent] for each in kept.seen])
        assert (belief[:, ~water] == 0).all() and (seen[:, ~water] == NEVER).all()
        differ += int((belief != replay.belief.reshape(belief.shape)).sum())
    assert differ > 0, "somebody does not know what the fleet knows together"


def test_an_item_is_known_from_the_first_step_in_which_a_map_has_it_where_it_was(
    replay: Recording,
) -> None:
    """By hand, from the maps: some look of step s, heard by then, shows items where it was at s."""
    held = held_of(replay)
    node = np.rint(replay.item_rc).astype(int)
    columns = replay.navigable.shape[1]
    for agent in range(4):
        belief, seen = held.maps(agent, replay.navigable.size)
        for item in range(node.shape[1]):
            first = UNKNOWN
            for step in range(len(seen)):
                for then in range(step + 1):
                    row, column = node[then, item]
                    cell = row * columns + column
                    if replay.item_present[then, item] and seen[step, cell] == then:
                        first = step if belief[step, cell] > 0 else first
                if first != UNKNOWN:
                    break
            assert held.known_from[agent, item] == first
    informed = held.known_from.max(axis=0) != UNKNOWN
    assert informed.any() and (held.known_from.min(axis=0) == UNKNOWN)[informed].any()


def test_contacts_and_losses_are_those_of_the_link(replay: Recording) -> None:
    held, mission = held_of(replay), Mission(setup_of(*LINK))
    mission.reset(3, np.arange(1))
    policy, radio = create_policy("greedy"), mission.exchange
    assert isinstance(radio, Radio)
    mission.prepare(policy)
    before = 0
    for step in range(len(held.changes)):
        total = int(radio.net.traffic.lost[0])
        assert held.lost[step].sum() == total - before
        assert not held.lost[step][~held.linked[step]].any(), "nothing is sent without contact"
        away = np.hypot(*np.moveaxis(replay.agent_rc[step][:, None] - replay.agent_rc[step], -1, 0))
        assert (away[held.linked[step]] <= 10.0).all() and not held.linked[step].diagonal().any()
        np.testing.assert_array_equal(held.linked[step], held.linked[step].T)
        np.testing.assert_array_equal(held.received[step], radio.knowledge.agent_seen)
        before = total
        if step < STEPS:
            mission.advance(mission.ask(policy))
    assert held.lost.sum() > 0 and held.linked.any() and not held.linked[-1].all()
    assert (held.received[:, range(4), range(4)] == np.arange(len(held.changes))[:, None]).all()


def test_idleness_grows_from_the_newest_look() -> None:
    """Of a look of step 1 it is 0 then and .25 a step later; what was never seen is idle."""
    held = KnowledgeRecord(0.25, *(np.zeros((0,), np.int32),) * 9)  # type: ignore[arg-type]
    seen = np.array([[NEVER, 0], [1, 0], [1, 0], [1, 0]], np.int16)
    idle = held.idleness(seen)
    np.testing.assert_array_equal(idle, [[1.0, 0.0], [0.0, 0.25], [0.25, 0.5], [0.5, 0.75]])


def test_a_replay_over_a_link_comes_back_from_its_file(replay: Recording, tmp_path: Path) -> None:
    path = tmp_path / "replay" / "a.npz"
    path.parent.mkdir()
    write_bytes(path, replay.content())
    back = held_of(Recording.load(path))
    for name, value in vars(held_of(replay)).items():
        np.testing.assert_array_equal(getattr(back, name), value)


def test_without_a_link_nothing_is_kept() -> None:
    replay = record(setup_of("horizon=3"), "graph", "greedy", 3, 0)
    assert replay.knowledge is None
    assert b"held_" not in replay.content()


@pytest.mark.parametrize(
    ("name", "spoil", "words"),
    [
        ("cell", lambda values: values + 10_000, "held_cell does not fit the map"),
        ("agent", lambda values: values - 1, "held_agent does not fit the map"),
        ("agent", lambda values: values[:-1], "held_cell of shape .* does not fit the others"),
        ("changes", lambda values: values + 1, "held_agent does not fit the map"),
        ("linked", lambda values: values[:, 1:], "held_linked of shape .* does not fit"),
        ("lost", None, "held_lost"),
    ],
)
def test_spoilt_files_are_named(
    replay: Recording, tmp_path: Path, name: str, spoil: object, words: str
) -> None:
    path = tmp_path / "replay" / "a.npz"
    path.parent.mkdir()
    write_bytes(path, replay.content())
    with np.load(path) as file:
        values = dict(file)
    if callable(spoil):
        values[f"held_{name}"] = spoil(values[f"held_{name}"])
    else:
        del values[f"held_{name}"]
    np.savez(path, **values)
    with pytest.raises(UserError, match=rf"replay .*a\.npz: cannot be read \(.*{words}"):
        Recording.load(path)


def test_a_recorder_takes_down_each_step_once() -> None:
    mission, recorder = Mission(setup_of(*LINK)), KnowledgeRecorder()
    mission.reset(3, np.arange(1))
    recorder.see(mission)
    held = recorder.record(mission)
    assert held.changes.shape == (1,) and held.changes[0] == len(held.cell) > 0
    assert (held.seen == 0).all() and set(held.agent) == {0, 1, 2, 3}
