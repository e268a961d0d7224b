"""Rendering for every environment of one picture: arrays, or a window on this display."""

import contextlib
import os
import sys
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from mjforage.base.errors import UserError


def why_no_window() -> str:
    """Reason why no window can be opened here; empty where one can be tried."""
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        return "there is no display"
    if find_spec("_tkinter") is None:
        return "this Python has no Tk (Debian: python3-tk)"
    return ""


RENDER_MODES = ["rgb_array", "human"]
"""Modes of every class: without `human` Gymnasium shows `rgb_array` in a window with pygame."""


def metadata_here(metadata: Mapping[str, Any]) -> dict[str, Any]:
    """Metadata of an environment made here: only modes that work, since checkers try each."""
    return {**metadata, "render_modes": RENDER_MODES[: 1 if why_no_window() else 2]}


class Window:
    """Opens before anything is played, and shows pictures from then on.

    Raises `UserError` if it cannot.
    """

    def __init__(self, title: str) -> None:
        try:
            import tkinter

            from PIL import ImageTk

            self._root = tkinter.Tk(className=title)
        except (ImportError, tkinter.TclError) as error:
            raise UserError(
                f"render_mode = 'human': no window can be opened ({error}); use rgb_array"
            ) from error
        self._photo_of, self._closed = ImageTk.PhotoImage, tkinter.TclError
        self._root.title(title)
        self._label = tkinter.Label(self._root)
        self._label.pack()

    def show(self, picture: NDArray[np.uint8]) -> None:
        """Show a picture (height, width, 3); a window that was closed stays closed."""
        with contextlib.suppress(self._closed):
            self._photo = self._photo_of(Image.fromarray(picture), master=self._root)
            self._label.configure(image=self._photo)
            self._root.update()

    def close(self) -> None:
        """Close it."""
        with contextlib.suppress(self._closed):
            self._root.destroy()


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
        """State of a copy, which is made to plan ahead and opens no window."""
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
