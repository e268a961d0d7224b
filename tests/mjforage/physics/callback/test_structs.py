"""Offsets follow MuJoCo's own declarations, and a struct that is not as declared is noticed."""

import copy
import ctypes

import mujoco
import pytest
from mujoco.introspect.structs import STRUCTS

from mjforage.physics.callback import structs
from mjforage.physics.callback.structs import StructError, offsets


@pytest.fixture
def declared(monkeypatch: pytest.MonkeyPatch) -> dict[str, object]:
    """Declarations of this test's own, and nothing remembered from those of MuJoCo."""
    own = copy.deepcopy(STRUCTS)
    monkeypatch.setattr(structs, "STRUCTS", own)
    monkeypatch.setattr(structs, "offsets", offsets.__wrapped__)
    return dict(own)


def without(declaration: object, name: str) -> None:
    """Take a member out of a declaration."""
    fields = tuple(f for f in declaration.fields if f.name != name)  # type: ignore[attr-defined]
    declaration.fields = fields  # type: ignore[attr-defined]


def test_members_are_where_the_offsets_say() -> None:
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>"
    )
    data, at = mujoco.MjData(model), offsets()
    for array, member in ((data.qvel, at.qvel), (data.M, at.mass), (data.qfrc_passive, at.force)):
        found = ctypes.c_void_p.from_address(data._address + member).value
        assert found == array.ctypes.data
    assert ctypes.c_double.from_address(model._address + at.timestep).value == model.opt.timestep


@pytest.mark.parametrize("struct", ["mjData", "mjModel"])
def test_a_struct_of_another_layout_is_noticed(struct: str, declared: dict[str, object]) -> None:
    first = declared[struct].fields[0].name  # type: ignore[attr-defined]
    without(declared[struct], first)  # everything behind it moves up by 8 bytes
    with pytest.raises(StructError, match="is not where MuJoCo"):
        structs.offsets()


def test_a_member_that_is_gone_is_named(declared: dict[str, object]) -> None:
    without(declared["mjData"], "userdata")
    with pytest.raises(StructError, match="userdata is no member of MuJoCo"):
        structs.offsets()


def test_a_member_of_unknown_type_is_named(declared: dict[str, object]) -> None:
    declared["mjOption"].fields[0].type.name = "mjtHalf"  # type: ignore[attr-defined]
    with pytest.raises(StructError, match=r"mjOption\.timestep is of the type mjtHalf"):
        structs.offsets()
