"""OpenGL without a display: choice of the library, and the one canvas of a process.

MuJoCo's renderer works through EGL or, without a driver for it, through OSMesa. Both are tried
here without loading OpenGL, as PyOpenGL stays with the first library it meets.
"""

import ctypes
import ctypes.util
import logging
import os
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.extras import require

logger = logging.getLogger(__name__)

VARIABLE = "MUJOCO_GL"
EGL, OSMESA = "egl", "osmesa"
PACKAGES = (
    "install Debian's libegl1 libegl-mesa0 libgl1-mesa-dri, or libosmesa6; a graph-level run is "
    "drawn without OpenGL by --camera top"
)
_DECIDE = (VARIABLE, "PYOPENGL_PLATFORM", "MUJOCO_EGL_DEVICE_ID")  # variables that decide
_NAMES = {EGL: "EGL", OSMESA: "OSMesa"}
_EGL_PLATFORM_DEVICE = 0x313F  # EGL_PLATFORM_DEVICE_EXT of EGL_EXT_platform_device
_MOST_DEVICES = 16


def choose_backend() -> str:
    """Name of the library to draw with: the user's MUJOCO_GL, else EGL, else OSMesa.

    Raises
    ------
    UserError
        If neither works here, or the user's choice draws only into windows.
    """
    asked = os.environ.get(VARIABLE, "").lower().strip()
    if asked in _NAMES:
        return asked
    if asked not in ("", "enable", "enabled", "on", "true", "1"):
        raise UserError(f"{VARIABLE}={asked}: draws no films; unset it, or set egl or osmesa")
    if egl_works():
        return EGL
    if osmesa_works():
        logger.warning("OpenGL: EGL has no driver here, OSMesa takes over")
        return OSMESA
    raise UserError(f"OpenGL: neither EGL nor OSMesa works here; {PACKAGES}")


def egl_works() -> bool:
    """True if EGL opens a device without a display, asked as MuJoCo does."""
    library = _load("EGL", "libEGL.so.1")
    if library is None:
        return False
    library.eglGetProcAddress.restype = ctypes.c_void_p
    query = library.eglGetProcAddress(b"eglQueryDevicesEXT")
    display_of = library.eglGetProcAddress(b"eglGetPlatformDisplayEXT")
    if not query or not display_of:
        return False
    devices, count = (ctypes.c_void_p * _MOST_DEVICES)(), ctypes.c_int(0)
    ask = ctypes.CFUNCTYPE(ctypes.c_uint, ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)(query)
    if not ask(_MOST_DEVICES, ctypes.byref(devices), ctypes.byref(count)):
        return False
    get = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_uint, ctypes.c_void_p, ctypes.c_void_p)
    for device in devices[: count.value]:
        display = get(display_of)(_EGL_PLATFORM_DEVICE, device, None)
        start = library.eglInitialize
        if display and start(ctypes.c_void_p(display), None, None):
            return True  # left open: MuJoCo opens the same one again
    return False


def osmesa_works() -> bool:
    """True if OSMesa makes a context."""
    library = _load("OSMesa", "libOSMesa.so.8")
    if library is None:
        return False
    create = library.OSMesaCreateContextExt
    create.restype = ctypes.c_void_p
    context = create(0x1908, 24, 8, 0, None)  # RGBA, depth and stencil bits
    if not context:
        return False
    library.OSMesaDestroyContext(ctypes.c_void_p(context))
    return True


def _load(name: str, file: str) -> Any:
    """The shared library, or None."""
    for candidate in (file, ctypes.util.find_library(name)):
        try:
            if candidate:
                return ctypes.CDLL(candidate)
        except OSError:
            continue
    return None


class Canvas:
    """Draws MuJoCo scenes into arrays. One per process, as drivers depend on several; close it.

    Attributes
    ----------
    about : library and driver, for people
    """

    _open: "Canvas | None" = None

    def __init__(self, model: mujoco.MjModel, width: int, height: int) -> None:
        """Open a canvas for one model.

        Raises
        ------
        UserError
            If there is no OpenGL here.
        RuntimeError
            If another canvas of this process is open.
        """
        if Canvas._open is not None:
            raise RuntimeError("another canvas is open in this process; close it first")
        chosen = _chosen()
        backend = choose_backend()
        os.environ.setdefault(VARIABLE, backend)
        self.width, self.height = width, height
        model.vis.global_.offwidth, model.vis.global_.offheight = width, height
        self._gl = _context(backend, width, height, chosen)
        Canvas._open = self
        try:
            self._gl.make_current()
            self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
            mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        except (mujoco.FatalError, RuntimeError) as error:
            self.close()
            raise _failure(backend, error, chosen) from error
        self.about = f"{_NAMES[backend]}, {_driver()}"
        logger.info("OpenGL: %s", self.about)

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


def _context(backend: str, width: int, height: int, chosen: str) -> Any:
    """MuJoCo's context of the backend; importing it loads OpenGL."""
    require("drawing in MuJoCo", "OpenGL")
    try:
        if backend == EGL:
            from mujoco.egl import GLContext
        else:
            from mujoco.osmesa import GLContext
        return GLContext(width, height)
    except Exception as error:  # OpenGL has many ways to fail
        raise _failure(backend, error, chosen) from error


def _chosen() -> str:
    """OpenGL variables of the user's environment, as VARIABLE=VALUE; "" if none."""
    return ", ".join(f"{name}={os.environ[name]}" for name in _DECIDE if os.environ.get(name))


def _failure(backend: str, error: Exception, chosen: str) -> UserError:
    """Error of a library that does not draw here; `chosen` by the user's environment."""
    reason = " ".join(str(error).split())
    words = f"OpenGL: {_NAMES[backend]} fails ({reason}); "
    return UserError(
        f"{chosen}: {words}unset it, or {PACKAGES}" if chosen else f"{words}{PACKAGES}"
    )


def _driver() -> str:
    from OpenGL import GL  # type: ignore[import-untyped]

    return bytes(GL.glGetString(GL.GL_RENDERER)).decode(errors="replace")
