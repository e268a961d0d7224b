"""Hulls of many worlds on a device, and kernels of ours between their steps.

All of them work in one memory and in one order; nothing goes to the host unless it is fetched. The
device is a GPU, or this processor, where MuJoCo Warp is slow.
"""

from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import Any, NamedTuple, cast

import numpy as np
import warp as wp
from numpy.typing import NDArray

from mjforage.base.device import SIMULATED, Call, Launch, OnDevice, require_gpu
from mjforage.base.errors import UserError
from mjforage.physics.scene import Scene
from mjforage.physics.warp_hulls import WarpHulls

Float32Array = NDArray[np.float32]


class Live(NamedTuple):
    """Warp's arrays of the hulls, in its memory."""

    places: Float32Array  # (world, 3 x vessel) half a step ahead, as MuJoCo has them
    velocities: Float32Array  # (world, 3 x vessel)
    lagged: Float32Array  # (world, 2 x vessel)
    commands: Float32Array  # (world, 2 x vessel)
    around: Float32Array  # (world, vessel, 9) fields of `vessel_motion.Surroundings`


class DeviceHulls:
    """Vessels without items, in many worlds.

    Attributes
    ----------
    arrays : of the host, and what they are on the device
    live : what stands for Warp's arrays
    step : moves all hulls on, a call as those of `bind`
    """

    def __init__(self, scene: Scene, worlds: int, *, step_s: float, device: str) -> None:
        """Set up worlds, vessels at the origin.

        Raises `UserError` if there is no such device.

        Parameters
        ----------
        scene : of `build_scene`, with no bodies for items
        step_s : time step [s]
        device : "warp-cpu" or "cuda"
        """
        if device not in ("warp-cpu", "cuda"):
            raise UserError(f"device = {device!r}: unknown; choose warp-cpu, cuda")
        if device == "cuda" and not SIMULATED:
            require_gpu("device cuda")
        self._worlds = worlds
        self._warp_name = "cuda" if device == "cuda" and not SIMULATED else "cpu"
        self.hulls = WarpHulls(scene, worlds, step_s=step_s, device=self._warp_name)
        self._here = device == "warp-cpu"
        self.step: Call = lambda stream: self.hulls.advance()
        self.arrays = OnDevice(self._here)
        self.renew()

    def renew(self, rows: NDArray[np.int64] | None = None) -> None:
        """Forget what arrays of the host are on the device, but Warp's, and what is bound to it.

        `rows`: worlds of which the host knows more; the memory of all stays, see `OnDevice`.
        """
        self.arrays = OnDevice(self._here) if rows is None else self.arrays.renewed(rows)
        self.live = Live(*map(self.arrays.shared, self.hulls.live))

    @property
    def memory_bytes(self) -> int:
        """Memory of a world on the device, with what kernels of ours have been bound to."""
        twice = sum(int(array.capacity) for array in self.hulls.live)
        return (self.hulls.memory_bytes + self.arrays.memory_bytes - twice) // self._worlds

    def bind(self, launch: Launch, *given: object) -> Call:
        """A kernel on arrays of the host, or rather on what these are on the device."""
        return launch.bound(self.arrays, self._worlds, *given)

    def run(self, calls: Sequence[Call]) -> None:
        """Make calls one after the other; they may still run when this returns.

        On a GPU they run in Warp's stream.
        """
        stream: Any = 0
        if self._warp_name == "cuda":
            stream = _stream(wp.get_stream("cuda"))
        for call in calls:
            call(stream)

    def beside_torch(self) -> AbstractContextManager[Any]:
        """In this, calls run in the order of what torch does on the device."""
        if self._warp_name == "cpu":
            return nullcontext()
        import torch

        warp: Any = wp
        stream = warp.stream_from_torch(torch.cuda.current_stream())
        return cast(AbstractContextManager[Any], warp.ScopedStream(stream))

    def wait(self) -> None:
        """Wait until all calls are done; raises `UserError` if contacts had no room."""
        self.synchronise()
        self.hulls.check()

    def synchronise(self) -> None:
        """Wait until all is done that was written or called, in whichever stream."""
        wp.synchronize_device(self._warp_name)


def _stream(of: Any) -> Any:
    """Warp's stream, for our kernels: what it runs in comes in the order of the calls."""
    from numba import cuda

    return cuda.external_stream(of.cuda_stream) if of.cuda_stream else 0
