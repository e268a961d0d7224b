"""OpenGL without a display: the one canvas of a process.

MuJoCo draws through EGL, or through OSMesa where `MUJOCO_GL=osmesa` is set: PyOpenGL stays with
the first library it meets, so a process cannot try one after the other.
"""

import os
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.extras import require

VARIABLE = "MUJOCO_GL"
EGL, OSMESA = "egl", "osmesa"
REMEDY = (
    "install Debian's libegl1 libegl-mesa0 libgl1-mesa-dri, or libosmesa6 and set "
    f"{VARIABLE}={OSMESA}; a graph-level run is drawn without OpenGL by camera top"
)


def choose_backend() -> str:
    """Name of the library to draw with: the user's MUJOCO_GL, else EGL.

    Raises `UserError` if the user's choice draws only into windows.
    """
    asked = os.environ.get(VARIABLE, "").lower().strip()
    if asked in (EGL, OSMESA):
        return asked
    if asked in ("", "enable", "enabled", "on", "true", "1"):
        return EGL
    raise UserError(f"{VARIABLE}={asked}: draws no films; unset it, or set egl or osmesa")


class Canvas:
    """Draws MuJoCo scenes into arrays. One per process, as drivers depend on several; close it."""

    _open: "Canvas | None" = None

    def __init__(self, model: mujoco.MjModel, width: int, height: int) -> None:
        """Open a canvas for one model.

        Raises `UserError` if there is no OpenGL here; `RuntimeError` if another canvas of this
        process is open.
        """
        if Canvas._open is not None:
            raise RuntimeError("another canvas is open in this process; close it first")
        backend = choose_backend()
        os.environ.setdefault(VARIABLE, backend)
        model.vis.global_.offwidth, model.vis.global_.offheight = width, height
        self._gl = _context(backend, width, height)
        Canvas._open = self
        try:
            self._gl.make_current()
            self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
            mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        except (mujoco.FatalError, RuntimeError) as error:
            self.close()
            raise _failure(backend, error) from error

    def draw(
        self, scene: mujoco.MjvScene, rgb: NDArray[np.uint8], depth: NDArray[np.float32]
    ) -> None:
        """Draw `scene` into `rgb` (h, w, 3) and `depth` (h, w) 0 near to 1 far; row 0 is lowest.

        The arrays may be smaller than the canvas.
        """
        area = mujoco.MjrRect(0, 0, depth.shape[1], depth.shape[0])
        mujoco.mjr_render(area, scene, self._context)
        mujoco.mjr_readPixels(rgb, depth, area, self._context)

    def close(self) -> None:
        """Give everything back; safe to repeat."""
        if Canvas._open is self:
            Canvas._open = None
            context = getattr(self, "_context", None)
            if context is not None:
                context.free()
            self._gl.free()

    def __enter__(self) -> "Canvas":
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


def _context(backend: str, width: int, height: int) -> Any:
    """MuJoCo's context of the backend; importing it loads OpenGL."""
    require("drawing in MuJoCo", "OpenGL")
    try:
        if backend == EGL:
            from mujoco.egl import GLContext
        else:
            from mujoco.osmesa import GLContext
        return GLContext(width, height)
    except Exception as error:  # OpenGL has many ways to fail
        raise _failure(backend, error) from error


def _failure(backend: str, error: Exception) -> UserError:
    return UserError(f"OpenGL: {backend} fails ({' '.join(str(error).split())}); {REMEDY}")
