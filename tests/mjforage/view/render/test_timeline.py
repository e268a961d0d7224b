from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording
from mjforage.view.render.panel import mission_clock
from mjforage.view.render.timeline import NEVER, course_at, timeline_of


@pytest.fixture
def small(build: Callable[..., Recording]) -> Recording:
    """Four items in nodes (0, 0)..(0, 3) of a 4 x 4 map over three steps, nothing seen."""
    replay = build(np.ones((4, 4), np.bool_), steps=3, items=4, agents=(1, 1))
    places = np.stack([np.zeros(4), np.arange(4) + 0.3], axis=1)
    return replace(
        replay,
        item_rc=np.tile(places.astype(np.float32), (4, 1, 1)),
        item_present=np.ones((4, 4), np.bool_),
        in_view=np.zeros_like(replay.in_view),
        t_discovered=np.full(4, -1, np.int16),
    )


def test_discoveries_as_logged_and_removals_give_pta(small: Recording) -> None:
    """What is in view and was missed is not discovered: the log says, not the picture."""
    present = small.item_present.copy()
    present[3:, 0] = False
    present[1:, 2] = False
    found = np.array([0, 2, 1, -1], np.int16)
    view = np.ones_like(small.in_view)
    timeline = timeline_of(replace(small, in_view=view, item_present=present, t_discovered=found))
    assert timeline.discovered.tolist() == [0, 2, 1, NEVER]
    assert timeline.removed.tolist() == [3, NEVER, 1, NEVER]
    assert timeline.pta_d.tolist() == [25.0, 50.0, 75.0, 75.0]
    assert timeline.pta_c.tolist() == [0.0, 25.0, 25.0, 50.0]


def test_a_replay_of_before_discoveries_is_read_but_not_drawn(
    small: Recording, tmp_path: Path
) -> None:
    path = tmp_path / "old.npz"
    path.write_bytes(replace(small, t_discovered=None).content())
    old = Recording.load(path)
    np.testing.assert_array_equal(old.item_rc, small.item_rc)
    with pytest.raises(UserError, match=r"tells no discoveries.*mjforage render"):
        timeline_of(old)


def test_course_follows_the_motion_and_is_kept_when_staying(small: Recording) -> None:
    east, south = [0.0, 1.0], [1.0, 0.0]
    steps = np.array([[0.0, 0.0], [0.0, 0.0], south])
    scout = np.cumsum(np.vstack([[[0.0, 0.0]], [east, [0.0, 0.0], south]]), axis=0)
    forager = np.cumsum(np.vstack([[[0.0, 0.0]], steps]), axis=0)
    route = np.stack([scout, forager], axis=1).astype(np.float32)
    timeline = timeline_of(replace(small, agent_rc=route))
    np.testing.assert_allclose(timeline.course[:, 0], [0.0, 0.0, 0.0, np.pi / 2])
    np.testing.assert_allclose(timeline.course[:, 1], np.pi / 2)
    assert 0.0 < course_at(timeline, 2.1)[0] < np.pi / 2
    np.testing.assert_allclose(course_at(timeline, 2.9)[0], np.pi / 2)


def test_turns_take_the_short_way(small: Recording) -> None:
    route = np.zeros((4, 2, 2), np.float32)
    route[:, 0] = [[0, 2], [-1, 0], [0, -2], [1, -4]]  # west by north, then west by south
    timeline = timeline_of(replace(small, agent_rc=route))
    assert abs(abs(course_at(timeline, 1.17)[0]) - np.pi) < 0.5


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.0, "00:00"), (69.9, "01:09"), (1500.0, "25:00"), (3725.0, "1:02:05")]
)
def test_mission_clock(seconds: float, text: str) -> None:
    assert mission_clock(seconds) == text
