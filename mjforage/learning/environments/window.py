"""`human`: a window on this machine's display that shows the present picture."""

import os
import sys
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from mjforage.core.errors import UserError


def display_exists() -> bool:
    """Whether there is a display to ask for a window, and Tk to ask with."""
    screen = not sys.platform.startswith("linux") or bool(os.environ.get("DISPLAY"))
    return screen and find_spec("_tkinter") is not None


RENDER_MODES = ["rgb_array", *(["human"] if display_exists() else [])]


class Window:
    """Opens with the first picture.

    Raises
    ------
    UserError
        If there is no display.
    """

    def __init__(self, title: str) -> None:
        try:
            import tkinter

            self._root = tkinter.Tk(className=title)
        except (ImportError, tkinter.TclError) as error:
            raise UserError(
                f"render_mode = 'human': no window can be opened ({error}); use rgb_array"
            ) from error
        self._root.title(title)
        self._label = tkinter.Label(self._root)
        self._label.pack()

    def show(self, picture: NDArray[np.uint8]) -> None:
        """Show a picture (height, width, 3); a window that was closed stays closed."""
        import tkinter

        from PIL import ImageTk

        try:
            self._photo = ImageTk.PhotoImage(Image.fromarray(picture), master=self._root)
            self._label.configure(image=self._photo)
            self._root.update()
        except tkinter.TclError:
            return

    def close(self) -> None:
        """Close it."""
        import contextlib
        import tkinter

        with contextlib.suppress(tkinter.TclError):
            self._root.destroy()
