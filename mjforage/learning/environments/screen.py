"""Rendering for every environment of one picture: arrays, or a window."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.learning.environments.window import RENDER_MODES, Window, why_no_window


def check_mode(mode: str | None, known: list[str] = RENDER_MODES) -> None:
    """Refuse a render mode that does not exist, or not here, before anything is played.

    Raises `UserError` if so.
    """
    if mode is None:
        return
    why = "unknown" if mode not in known else why_no_window() if mode == "human" else ""
    if why:
        names = ", ".join(str(one) for one in (None, *known) if one != mode)
        raise UserError(f"render_mode = {mode!r}: {why}; choose {names}")


class Screen:
    """Draws the present on demand (`rgb_array`), or after every change in a window (`human`)."""

    def __init__(self, mode: str | None, draw: Callable[[], NDArray[np.uint8]]) -> None:
        check_mode(mode)
        self._mode, self._draw = mode, draw
        self._window = Window("mjforage") if mode == "human" else None

    def __getstate__(self) -> dict[str, Any]:
        """For a copy, which is made to think ahead and opens no window."""
        return vars(self) | {"_window": None}

    def refresh(self) -> None:
        """Something has changed."""
        if self._window is not None:
            self._window.show(self._draw())

    def render(self) -> NDArray[np.uint8] | None:
        """(height, width, 3) the present, or None without `rgb_array`."""
        return self._draw() if self._mode == "rgb_array" else None

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._window is not None:
            self._window.close()
