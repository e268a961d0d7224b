"""Byte offsets of the members of mjModel and mjData that the callback reads.

MuJoCo gives native callbacks two struct addresses and no header to read them with. The
declarations of its structs ship with the Python package (`mujoco.introspect`); ctypes lays them out
as the C compiler did. Every offset is then checked on a toy model: the member must have the
address of the array that Python sees, or the number. The self-test proves the result.
"""

import ctypes
from functools import lru_cache
from typing import Any, NamedTuple

import mujoco
from mujoco.introspect.ast_nodes import AnonymousUnionDecl, ArrayType, PointerType, ValueType
from mujoco.introspect.structs import STRUCTS

_SCALARS: dict[str, Any] = {
    "char": ctypes.c_char,
    "double": ctypes.c_double,
    "float": ctypes.c_float,
    "int": ctypes.c_int,
    "mjtBool": ctypes.c_ubyte,
    "mjtByte": ctypes.c_ubyte,
    "mjtNum": ctypes.c_double,
    "mjtSize": ctypes.c_int64,
    "size_t": ctypes.c_size_t,
    "uint64_t": ctypes.c_uint64,
    "uintptr_t": ctypes.c_void_p,
}

_TOY = """
<mujoco>
  <option timestep="0.0123456789"/><size nuserdata="1013"/>
  <custom><numeric name="mark" size="491" data="1"/></custom>
  <worldbody><body>
    <joint name="x" type="slide" range="1 2" limited="true"/><geom size="1"/>
  </body></worldbody>
  <actuator><general joint="x" dyntype="filter" gainprm="0"/></actuator>
</mujoco>
"""


class StructError(RuntimeError):
    """MuJoCo's structs are not as it declares them; the native callback cannot run."""


class Offsets(NamedTuple):
    """Byte offsets of members. Of mjModel: the first five; of mjData: the rest."""

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
    n_rows: int
    rows_gap: int
    rows_margin: int
    rows_response: int


def _c_type(declared: Any, where: str) -> Any:
    """The ctypes type of a declaration of `mujoco.introspect`."""
    if isinstance(declared, PointerType):
        return ctypes.c_void_p
    if isinstance(declared, ArrayType):
        made = _c_type(declared.inner_type, where)
        for extent in reversed(declared.extents):
            made *= extent
        return made
    if not isinstance(declared, ValueType):
        return _c_struct(declared, where)
    if declared.name in STRUCTS:
        return _c_struct(STRUCTS[declared.name], declared.name)
    if declared.name not in _SCALARS:
        raise StructError(f"{where} is of the type {declared.name}, whose size is not known")
    return _SCALARS[declared.name]


def _c_struct(declared: Any, where: str) -> Any:
    """The ctypes structure (or union) with the members of a declaration."""
    base: Any = ctypes.Union if isinstance(declared, AnonymousUnionDecl) else ctypes.Structure
    members = [
        (member.name, _c_type(member.type, f"{where}.{member.name}")) for member in declared.fields
    ]
    return type(where, (base,), {"_fields_": members})


def _offset(layout: Any, address: int, member: str, expected: float) -> int:
    """Offset of a member that holds `expected`, in the struct at `address`."""
    at: int = 0
    for name in member.split("."):
        if not hasattr(layout, name):
            raise StructError(f"{member} is no member of MuJoCo {mujoco.__version__}'s structs")
        at += getattr(layout, name).offset
        layout = dict(layout._fields_)[name]
    if layout.from_address(address + at).value != expected:
        raise StructError(f"{member} is not where MuJoCo {mujoco.__version__} declares it")
    return at


@lru_cache(maxsize=1)
def offsets() -> Offsets:
    """Offsets in the structs of this process's MuJoCo.

    Raises `StructError` if a member is missing, of an unknown type, or does not hold what it
    should.
    """
    model = mujoco.MjModel.from_xml_string(_TOY)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)  # the joint is out of its range: a row of constraints
    of_model, of_data = (_c_struct(STRUCTS[name], name) for name in ("mjModel", "mjData"))

    def in_model(member: str, expected: float) -> int:
        return _offset(of_model, model._address, member, expected)

    def in_data(member: str) -> int:
        return _offset(of_data, data._address, member, getattr(data, member).ctypes.data)

    return Offsets(
        n_numeric=in_model("nnumericdata", model.numeric_data.size),
        n_user=in_model("nuserdata", model.nuserdata),
        timestep=in_model("opt.timestep", model.opt.timestep),
        numeric=in_model("numeric_data", model.numeric_data.ctypes.data),
        row_start=in_model("M_rowadr", model.M_rowadr.ctypes.data),
        qpos=in_data("qpos"),
        qvel=in_data("qvel"),
        act=in_data("act"),
        ctrl=in_data("ctrl"),
        userdata=in_data("userdata"),
        force=in_data("qfrc_passive"),
        mass=in_data("M"),
        n_rows=_offset(of_data, data._address, "nefc", data.nefc),
        rows_gap=in_data("efc_pos"),
        rows_margin=in_data("efc_margin"),
        rows_response=in_data("efc_KBIP"),
    )
