from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording
from mjforage.view.render import TopView, default_camera, needs_opengl, opengl, render_replay


@pytest.fixture(scope="module")
def replay(build: Callable[..., Recording]) -> Recording:
    return build(np.ones((8, 8), np.bool_), steps=3, items=3)


@pytest.fixture
def blind(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine without OpenGL."""
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(opengl, "_load", lambda name, file: None)


def test_only_the_graph_world_from_above_is_plain_drawing() -> None:
    assert default_camera("graph") == "top"
    assert default_camera("physics") == default_camera("hulls") == "overview"
    assert not needs_opengl("graph", "top")
    assert needs_opengl("physics", "top")
    assert needs_opengl("graph", "overview")


@pytest.mark.usefixtures("blind")
def test_plain_drawing_needs_no_opengl_and_the_rest_says_so(
    replay: Recording, tmp_path: Path
) -> None:
    assert render_replay(replay, tmp_path / "a.png", size=(480, None)) == 1
    with pytest.raises(UserError, match="neither EGL nor OSMesa"):
        render_replay(replay, tmp_path / "b.png", camera="overview")
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"camera": "front"}, "camera front: unknown; choose overview, chase, top, scout"),
        ({"size": (10, None)}, "width 10: must be 320 to 7680"),
        ({"size": (None, 480)}, "height 480: the drawing from above finds its own"),
        ({"follow": "scouts_0"}, "follow scouts_0: camera top follows nobody"),
        ({"camera": "overview", "size": (20, None)}, "width 20: must be 64 to 3840 pixels"),
        ({"camera": "chase", "size": (None, 9000)}, "height 9000: must be 64 to 2160 pixels"),
    ],
)
def test_bad_options_are_named(
    replay: Recording, tmp_path: Path, options: dict[str, Any], message: str
) -> None:
    with pytest.raises(UserError, match=message):
        render_replay(replay, tmp_path / "film.mp4", **options)
    assert list(tmp_path.iterdir()) == []


def test_the_plain_drawing_is_the_top_view(replay: Recording, tmp_path: Path) -> None:
    from PIL import Image as PilImage

    render_replay(replay, tmp_path / "a.png", size=(480, None), start_s=15.0)
    shown = np.asarray(PilImage.open(tmp_path / "a.png"))
    np.testing.assert_array_equal(shown, TopView(replay, 480).frame(1.5))
