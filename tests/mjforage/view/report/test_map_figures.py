"""The scenario figure of a report."""

from dataclasses import replace

import numpy as np

from mjforage.view.page.figure import canvas
from mjforage.view.report.map_figures import _fleet
from tests.mjforage.view.report.made_up_episodes import Plan, made_up_episode


def test_hulls_point_where_they_went_last_until_the_step_that_is_shown() -> None:
    """To the east up to step 4, then to the north."""
    replay = made_up_episode(Plan(), "graph", "greedy", 0, 1.0).replay
    steps = np.arange(len(replay.agent_rc))
    way = np.stack((-np.maximum(steps - 4, 0), np.minimum(steps, 4)), axis=1)
    tracks = np.repeat(way[:, None], replay.agent_rc.shape[1], axis=1) + np.float32(9)
    axes = canvas(4.0, 4.0).subplots()
    for step, bow in ((4, (1.0, 0.0)), (6, (0.0, 1.0))):
        _fleet(axes, replace(replay, agent_rc=tracks.astype(np.float32)), step)
        turn = vars(axes.lines[-1])["_marker"].get_user_transform()
        np.testing.assert_allclose(turn.transform((0.0, 1.0)), bow, atol=1e-9)
