"""Where mjModel and mjData keep what the callback reads, found by looking.

MuJoCo gives native callbacks two struct addresses and no header to read them with. A toy model
with telling values is compiled once; the struct is searched for the addresses of its arrays and
for its sizes. The self-test then proves the result.
"""

import ctypes
from functools import lru_cache
from typing import Any, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

DATA_BYTES, MODEL_BYTES = 162_096, 5_672  # searched at most: the struct sizes of MuJoCo 3.17.0
N_NUMERIC, N_USER, TIMESTEP_S = 491, 1013, 0.0123456789  # of the toy model, found nowhere else

_TOY = f"""
<mujoco>
  <option timestep="{TIMESTEP_S}"/><size nuserdata="{N_USER}"/>
  <custom><numeric name="mark" size="{N_NUMERIC}" data="1"/></custom>
  <worldbody><body><joint name="x" type="slide"/><geom size="1"/></body></worldbody>
  <actuator><general joint="x" dyntype="filter" gainprm="0"/></actuator>
</mujoco>
"""


class StructError(RuntimeError):
    """A field is not where this MuJoCo's structs were searched; the native callback cannot run."""


class Offsets(NamedTuple):
    """Byte offsets of fields. Of mjModel: the first five; of mjData: the rest."""

    n_numeric: int
    n_user: int
    timestep: int
    numeric: int
    row_start: int
    qpos: int
    qvel: int
    act: int
    ctrl: int
    userdata: int
    force: int
    mass: int


def _words(address: int, nbytes: int, dtype: str) -> NDArray[np.generic]:
    raw: Any = (ctypes.c_ubyte * nbytes).from_address(address)
    return np.asarray(raw).view(dtype)


def _find(words: NDArray[np.generic], value: float, what: str) -> int:
    """Offset of the last hit: mjData also points at its whole buffer, which begins with qpos."""
    hits = np.flatnonzero(words == value)
    if hits.size == 0:
        raise StructError(f"{what} not found in the structs of MuJoCo {mujoco.__version__}")
    return int(hits[-1]) * words.itemsize


@lru_cache(maxsize=1)
def offsets() -> Offsets:
    """Search the structs of this process's MuJoCo.

    Raises
    ------
    StructError
        If a field is not found.
    """
    model = mujoco.MjModel.from_xml_string(_TOY)
    data = mujoco.MjData(model)
    ints = _words(model._address, MODEL_BYTES, "i4")
    reals = _words(model._address, MODEL_BYTES, "f8")
    model_pointers = _words(model._address, MODEL_BYTES, "u8")
    data_pointers = _words(data._address, DATA_BYTES, "u8")

    def in_model(array: NDArray[np.generic], what: str) -> int:
        return _find(model_pointers, array.ctypes.data, what)

    def in_data(array: NDArray[np.generic], what: str) -> int:
        return _find(data_pointers, array.ctypes.data, what)

    return Offsets(
        n_numeric=_find(ints, N_NUMERIC, "nnumericdata"),
        n_user=_find(ints, N_USER, "nuserdata"),
        timestep=_find(reals, TIMESTEP_S, "opt.timestep"),
        numeric=in_model(model.numeric_data, "numeric_data"),
        row_start=in_model(model.M_rowadr, "M_rowadr"),
        qpos=in_data(data.qpos, "qpos"),
        qvel=in_data(data.qvel, "qvel"),
        act=in_data(data.act, "act"),
        ctrl=in_data(data.ctrl, "ctrl"),
        userdata=in_data(data.userdata, "userdata"),
        force=in_data(data.qfrc_passive, "qfrc_passive"),
        mass=in_data(data.M, "M"),
    )
