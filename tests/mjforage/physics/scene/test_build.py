import dataclasses

import mujoco
import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.physics.callback.model_layout import HEADER, MAGIC
from mjforage.physics.hydrodynamics.parameters import pack_fleet
from mjforage.physics.scene import build_scene, with_bodies
from mjforage.physics.vessels import load_vessel
from mjforage.scenario.maps import load_map
from mjforage.scenario.vessel_files import vessel_names

SCOUT, FORAGER = load_vessel("scout"), load_vessel("forager")
PORT = load_map("comb_port").navigable


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


def test_a_vessel_too_large_for_its_corridor_is_named() -> None:
    with pytest.raises(
        UserError, match=r"forager: a vessel of 2 m x 1.08 m needs 2.27 m to turn, .* 2 m"
    ):
        build_scene([SCOUT, FORAGER], navigable=PORT, pitch_m=1.0)


def test_scenes_that_cannot_be_built_are_named() -> None:
    assert build_scene([SCOUT, FORAGER, SCOUT]).names == ("scout_0", "forager_1", "scout_2")
    with pytest.raises(UserError, match="map of 2 x 3 cells: no water"):
        build_scene([SCOUT], navigable=np.zeros((2, 3), bool))
    with pytest.raises(UserError, match="no vessel"):
        build_scene([])


def test_a_vessel_without_a_part_of_its_own_borrows_looks() -> None:
    own = dataclasses.replace(SCOUT, name="mine")
    assert build_scene([own]).model.geom("mine_0/collider").size[0] == 0.5 * SCOUT.length_m


def test_the_softness_of_item_contacts_is_of_the_default_density(model: mujoco.MjModel) -> None:
    mass = 1000.0 * 4.0 / 3.0 * np.pi * 0.1**3  # [kg] of the collider's sphere
    assert model.body("item-3/item").mass[0] == pytest.approx(mass, rel=1e-12)
