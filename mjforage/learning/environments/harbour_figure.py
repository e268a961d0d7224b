"""The vessels of an environment in 3-D, as MuJoCo draws them."""

from typing import TYPE_CHECKING, Any, ClassVar, Optional

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.runs.episode_recording import Recording

if TYPE_CHECKING:
    from mjforage.view.render.harbour_view import HarbourView

WIDTH, HEIGHT = 640, 360  # pixels


def check_camera(camera: str | None, world: str, mode: str | None) -> None:
    """Refuse a camera that does not exist, or has nothing to show. Raises `UserError` if so."""
    if camera is None:
        return
    from mjforage.view.render.cameras import CAMERAS

    if camera not in CAMERAS:
        raise UserError(f"camera = {camera!r}: unknown; {nearest(camera, CAMERAS)}")
    if world == "graph":
        raise UserError(
            f"camera = {camera!r}: the graph world has no hulls; choose world='physics', or leave "
            "the camera out to see the map from above"
        )
    if mode is None:
        raise UserError(
            f"camera = {camera!r}: nothing is drawn without a render_mode; choose rgb_array"
        )


class HarbourFigure:
    """One view from a camera, opened with the first picture of an episode.

    A process has but one canvas: of several that draw in turn, each takes it from the one before,
    which opens its view again when it is next asked. A copy has no view of its own yet.
    """

    _drawing: ClassVar[Optional["HarbourFigure"]] = None

    def __init__(self, camera: str) -> None:
        self._camera = camera
        self._view: HarbourView | None = None

    def draw(self, replay: Recording, step: int) -> NDArray[np.uint8]:
        """(HEIGHT, WIDTH, 3) the last step of an episode that goes on.

        Raises `UserError` if there is no OpenGL.
        """
        if self._view is None:
            self._view = self._opened(replay)
        else:
            self._view.go_on(replay)
        return self._view.picture(float(step))

    def _opened(self, replay: Recording) -> "HarbourView":
        from mjforage.view.render.harbour_view import HarbourView

        if HarbourFigure._drawing is not None:
            HarbourFigure._drawing.close()
        view = HarbourView(replay, self._camera, WIDTH, HEIGHT)
        HarbourFigure._drawing = self
        return view

    def close(self) -> None:
        """Give OpenGL back; the next picture opens it again."""
        if self._view is not None:
            self._view.close()
            self._view, HarbourFigure._drawing = None, None

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "_view": None}
