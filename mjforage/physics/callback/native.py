"""A compiled C callback that MuJoCo calls without the GIL, also in Batch threads.

A pointer to it is process-global in MuJoCo, so it looks at the model first and leaves every model
alone that does not begin its numerics with our mark.
"""

import ctypes
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import mujoco
from numba import cfunc, types
from numba.extending import intrinsic
from numba.np.numpy_support import carray

from mjforage.physics.callback.contact_rows import prepare_rows
from mjforage.physics.callback.forces import MujocoState, apply
from mjforage.physics.callback.model_layout import (
    HEADER,
    ITEM_DOFS,
    MAGIC,
    N_ITEMS,
    N_VESSELS,
    VESSEL_DOFS,
)
from mjforage.physics.callback.structs import StructError, offsets


def _pointer(ctype: Any) -> Any:
    """A function of numba's that reads an address as a pointer to `ctype`."""

    @intrinsic
    def at(typing_context: Any, address: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return builder.inttoptr(args[0], context.get_value_type(signature.return_type))

        signature: Any = types.CPointer(ctype)  # type: ignore[no-untyped-call]
        return signature(types.uintp), generate

    return at


_f64, _i32 = _pointer(types.float64), _pointer(types.int32)
_size, _address = _pointer(types.int64), _pointer(types.uintp)  # mjtSize, and any pointer


def _factor_m() -> Any:
    """`mj_factorM` of the library that the Python package loaded."""
    folder = Path(mujoco.__file__).parent
    for pattern in ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll"):
        for path in sorted(folder.glob(pattern)):
            function = ctypes.CDLL(str(path)).mj_factorM
            function.argtypes, function.restype = [ctypes.c_void_p, ctypes.c_void_p], None
            return function
    raise StructError(f"no MuJoCo library in {folder}")


@lru_cache(maxsize=1)
def native_callback() -> Any:
    """Compile the callback for this process; keep the result alive as long as it is installed.

    Raises `StructError` if the structs or the library are not what the callback needs.
    """
    at, factor_m = offsets(), _factor_m()
    o_n_numeric, o_n_user, o_timestep, o_numeric, o_row = at[:5]
    o_qpos, o_qvel, o_act, o_ctrl, o_userdata, o_force, o_mass = at[5:12]
    o_n_rows, o_gap, o_margin, o_response = at[12:]

    def passive(m: int, d: int) -> None:
        n_numeric, n_user = _size(m + o_n_numeric)[0], _size(m + o_n_user)[0]
        if n_numeric < HEADER:
            return
        numeric = carray(_f64(_address(m + o_numeric)[0]), n_numeric)
        if numeric[0] != MAGIC:
            return
        vessels, items = int(numeric[N_VESSELS]), int(numeric[N_ITEMS])
        dofs = vessels * VESSEL_DOFS + items * ITEM_DOFS
        row = carray(_i32(_address(m + o_row)[0]), dofs)
        state = MujocoState(
            numeric,
            row,
            carray(_f64(_address(d + o_qpos)[0]), dofs),
            carray(_f64(_address(d + o_qvel)[0]), dofs),
            carray(_f64(_address(d + o_act)[0]), 2 * vessels),
            carray(_f64(_address(d + o_ctrl)[0]), 2 * vessels),
            carray(_f64(_address(d + o_userdata)[0]), n_user),
            carray(_f64(_address(d + o_force)[0]), dofs),
            carray(_f64(_address(d + o_mass)[0]), row[dofs - 1] + dofs),
            _f64(m + o_timestep)[0],
        )
        apply(state)
        factor_m(m, d)
        rows = _i32(d + o_n_rows)[0]
        if rows > 0:
            prepare_rows(
                carray(_f64(_address(d + o_gap)[0]), rows),
                carray(_f64(_address(d + o_margin)[0]), rows),
                carray(_f64(_address(d + o_response)[0]), 4 * rows),
            )

    signature = types.void(types.uintp, types.uintp)
    compiled: Callable[..., Any] = cfunc(signature)(passive)
    return compiled
