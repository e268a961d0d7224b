import dataclasses
import re
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.physics.callback.model_layout import HEADER, MAGIC
from mjforage.physics.hydrodynamics.parameters import pack_fleet
from mjforage.physics.scene import build_scene, check_passages, with_bodies
from mjforage.physics.vessels import load_vessel
from mjforage.scenario.assets import models_folder
from mjforage.scenario.maps import load_map
from mjforage.scenario.vessel_files import vessel_names

SCOUT, FORAGER = load_vessel("scout"), load_vessel("forager")
PORT = load_map("comb_port").navigable
HULL, COLLIDER = '<body name="hull">', 'name="collider" class="vessel"'


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return build_scene([SCOUT, FORAGER], navigable=PORT, pitch_m=4.0, items=7).model


def test_the_callback_finds_its_numbers_first(model: mujoco.MjModel) -> None:
    assert model.numeric_data[:4].tolist() == [MAGIC, 2, 7, 5]
    fleet = pack_fleet([SCOUT, FORAGER]).view(np.float64)
    np.testing.assert_array_equal(model.numeric_data[HEADER:][: fleet.size], fleet)


def test_rows_of_the_mass_matrix_hold_what_the_callback_writes(model: mujoco.MjModel) -> None:
    assert model.M_rownnz.tolist() == [1, 2, 3] * 2 + [1, 1] * 7


def test_vessels_without_offset_keep_the_whole_mass_matrix() -> None:
    vessel = dataclasses.replace(load_vessel("otter"), cog_x_m=0.0)
    assert build_scene([vessel]).model.M_rownnz.tolist() == [1, 2, 3]


@pytest.mark.parametrize("name", vessel_names())
def test_inertia_comes_from_the_parameters(name: str) -> None:
    vessel = load_vessel(name)
    model = build_scene([vessel]).model
    body = model.body(f"{name}_0/hull")
    assert body.mass[0] == vessel.mass_kg
    about_midships = body.inertia[2] + vessel.mass_kg * body.ipos[0] ** 2
    assert about_midships == pytest.approx(vessel.inertia_z_kgm2, rel=1e-9)
    size = model.geom(f"{name}_0/collider").size
    assert size[:2].tolist() == [0.5 * vessel.length_m, 0.5 * vessel.beam_m]


def test_more_bodies_for_items_leave_quays_where_they_are() -> None:
    scene = build_scene([SCOUT], navigable=PORT, pitch_m=5.0, items=2)
    grown = with_bodies(scene, 4)
    assert (grown.items, grown.pitch_m) == (4, 5.0)
    np.testing.assert_array_equal(
        *(one.model.geom_pos[one.model.geom_bodyid == 0] for one in (scene, grown))
    )


def test_water_and_quays_are_where_the_map_has_them(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    rows, cols = PORT.shape
    quays = [g for g in range(model.ngeom) if model.geom(g).name.startswith("quay")]
    centre, half = data.geom_xpos[quays, :2], model.geom_size[quays, :2]
    for row, col in np.ndindex(rows, cols):
        point = np.array([col * 4.0, (rows - 1 - row) * 4.0])
        on_land = (np.abs(point - centre) < half).all(axis=1).any()
        assert on_land != PORT[row, col]


def test_items_wait_apart_and_away() -> None:
    scene = build_scene([SCOUT], navigable=PORT, pitch_m=4.0, items=30)
    assert (np.diff(scene.parking[:, 0]) <= -1.0).all()
    assert (scene.parking < -20.0).all()


def test_looks_add_nothing_that_touches() -> None:
    bare = build_scene([SCOUT, FORAGER], items=5).model
    shown = build_scene([SCOUT, FORAGER], items=5, looks=[0, 1, 2, 3, 4]).model
    assert shown.ngeom > bare.ngeom + 40
    assert np.count_nonzero(shown.geom_contype) == np.count_nonzero(bare.geom_contype)
    np.testing.assert_array_equal(shown.body_mass, bare.body_mass)


def test_a_hull_too_large_for_its_corridor_is_named() -> None:
    check_passages([SCOUT, FORAGER], PORT, 4.0)
    with pytest.raises(
        UserError, match=r"forager: a vessel of 2 m x 1.08 m needs 2.27 m to turn, .* 2 m"
    ):
        build_scene([SCOUT, FORAGER], navigable=PORT, pitch_m=1.0)


def test_malformed_models_are_named(tmp_path: Path) -> None:
    file = tmp_path / "mine.xml"
    for text, message in (
        ("<mujoco><worldbody>", "mine.xml: malformed MJCF"),
        ("<mujoco/>", "mine.xml: no body named hull"),
        (
            '<mujoco><worldbody><body name="hull"><freejoint name="f"/><geom size="1"/></body>'
            "</worldbody></mujoco>",
            "joints of hull are f; give x, y, yaw",
        ),
    ):
        file.write_text(text)
        with pytest.raises(UserError, match=message):
            build_scene([SCOUT], parts={"scout": file})
    good = (models_folder() / "otter.xml").read_text(encoding="utf-8")
    for old, new, message in (  # what the file has, what is put there, what the error says
        ('axis="1 0 0"', 'axis="0 1 0"', "joint x is no slide along x"),
        ('name="yaw" type="hinge"', 'name="yaw" type="slide"', "joint yaw is no hinge along z"),
        (
            'name="x" type="slide"',
            'name="x" damping="3" type="slide"',
            "joint x has damping",
        ),
        ('name="collider"', 'name="box"', "no box named collider"),
        (HULL, '<body name="hull" pos="0 0.1 0">', "body hull is moved or turned"),
        (HULL, '<body name="hull" euler="0 0 5">', "body hull is moved or turned"),
        ("</body>", '<body><geom size="1"/></body></body>', "hull holds bodies of its own"),
        ("</body>", '<body><joint/><geom size="1"/></body></body>', "bodies of its own"),
        ('name="x" type', 'name="x" pos="0 0.1 0" type', "joint x has a pos or ref"),
        ('name="yaw" type', 'name="yaw" ref="90" type', "joint yaw has a pos or ref"),
        ('name="y" type', 'name="y" range="-5 5" limited="true" type', "joint y is limited"),
        (COLLIDER, f'{COLLIDER} pos="0 0 0.1"', "collider is moved or turned"),
        (COLLIDER, f'{COLLIDER} euler="0 0 90"', "collider is moved or turned"),
        (COLLIDER, f'{COLLIDER} contype="1"', "collider has contype 1 and conaffinity 7; give"),
        (COLLIDER, f'{COLLIDER} conaffinity="0"', "contype 2 and conaffinity 0; give 2 and 7"),
        (
            "</body>",
            '<geom name="bowsprit" size="1" contype="2"/></body>',
            "geom bowsprit touches things; give it contype",
        ),
        (
            "</mujoco>",
            '<actuator><motor joint="x"/></actuator></mujoco>',
            "has actuators, tendons, equalities or contact pairs; remove them",
        ),
    ):
        assert old in good
        file.write_text(good.replace(old, new, 1))
        with pytest.raises(UserError, match=message):
            build_scene([SCOUT], parts={"scout": file})
    with pytest.raises(UserError, match="no such file"):
        build_scene([SCOUT], parts={"scout": tmp_path / "none.xml"})


def test_names_are_counted_by_vessel_and_must_differ() -> None:
    assert build_scene([SCOUT, FORAGER, SCOUT]).names == ("scout_0", "forager_0", "scout_1")
    with pytest.raises(UserError, match="give 2 different ones"):
        build_scene([SCOUT, FORAGER], names=["a", "a"])
    for name in ("", "a/b"):
        with pytest.raises(
            UserError, match=f"name '{name}' of a vessel: give text without a slash"
        ):
            build_scene([SCOUT], names=[name])
    with pytest.raises(UserError, match="-1 items; give a whole number, 0 or more"):
        build_scene([SCOUT], items=-1)
    with pytest.raises(UserError, match="map of 2 x 3 cells: no water"):
        build_scene([SCOUT], navigable=np.zeros((2, 3), bool))
    with pytest.raises(UserError, match="no vessel"):
        build_scene([])


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"items": 2.5}, "2.5 items; give a whole number, 0 or more"),
        ({"items": True}, "True items; give a whole number"),
        ({"items": 2, "looks": [0]}, "1 looks for 2 items; give one for each"),
        ({"items": 2, "looks": [0, 5]}, "look 5; give classes from 0 to 4"),
        ({"items": 2, "looks": [0, -1]}, "look -1; give classes from 0 to 4"),
        ({"items": 2, "looks": [0, 0.5]}, "look 0.5; give classes from 0 to 4"),
        ({"items": 2, "classes": []}, "2 items and no debris class; give a class"),
        *(
            ({"pitch_m": pitch}, f"pitch {pitch:g} m; give a finite number above 0")
            for pitch in (0.0, -4.0, np.nan, np.inf)
        ),
    ],
)
def test_bad_settings_of_a_scene_are_named(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError, match=f"scene: {re.escape(message)}"):
        build_scene([SCOUT], navigable=PORT, **settings)


def test_a_scene_without_items_needs_no_class() -> None:
    assert build_scene([SCOUT], classes=[], looks=[]).items == 0
    assert build_scene([SCOUT], items=np.int64(2), looks=np.array([0, 1])).items == 2  # type: ignore[arg-type]


def test_a_vessel_without_a_part_of_its_own_borrows_looks() -> None:
    own = dataclasses.replace(SCOUT, name="mine")
    assert build_scene([own]).model.geom("mine_0/collider").size[0] == 0.5 * SCOUT.length_m
