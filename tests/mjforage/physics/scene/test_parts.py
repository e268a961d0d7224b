"""Each file of `models/*.xml` alone in plain MuJoCo: masses, centres, inertias and thrusters."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from mjforage.physics.vessels import load_vessel
from mjforage.scenario.assets import models_folder
from mjforage.scenario.debris import load_debris

FILES = {path.stem: path for path in sorted(models_folder().glob("*.xml"))}
VESSELS = [name for name in FILES if (models_folder() / "vessels" / f"{name}.toml").is_file()]


def loaded(path: Path) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(path))


def test_vessels_are_all_parts_but_water_and_debris() -> None:
    assert {*FILES} - {*VESSELS} == {"scene", "debris"}
    assert loaded(FILES["scene"]).body_mass.sum() == 0.0


@pytest.mark.parametrize("name", VESSELS)
def test_a_vessel_has_mass_centre_and_inertia_of_its_file(name: str) -> None:
    vessel, model = load_vessel(name), loaded(FILES[name])
    hull = model.body("hull")
    assert model.body_mass.sum() == pytest.approx(vessel.mass_kg, rel=1e-6)
    np.testing.assert_allclose(hull.ipos, (vessel.cog_x_m, 0.0, 0.0), atol=1e-6)
    about_midships = hull.inertia[2] + hull.mass[0] * hull.ipos[0] ** 2
    assert about_midships == pytest.approx(vessel.inertia_z_kgm2, rel=1e-6)


@pytest.mark.parametrize("name", VESSELS)
def test_a_vessel_has_two_motors_with_the_thrust_of_its_file(name: str) -> None:
    vessel, model = load_vessel(name), loaded(FILES[name])
    assert [model.actuator(i).name for i in range(model.nu)] == ["port", "starboard"]
    for side, way in (("port", 1.0), ("starboard", -1.0)):
        motor, site = model.actuator(side), model.site(side)
        assert motor.ctrlrange == pytest.approx(vessel.thruster.thrust_range, rel=1e-6)
        assert site.pos[1] == pytest.approx(way * vessel.lever_m, abs=1e-6)
        assert -0.5 * vessel.length_m <= site.pos[0] < -0.4 * vessel.length_m
        data = mujoco.MjData(model)
        data.ctrl[motor.id] = 2.0 * motor.ctrlrange[1]
        mujoco.mj_forward(model, data)
        ahead = vessel.thruster.thrust_range[1]
        np.testing.assert_allclose(
            data.qfrc_actuator, (ahead, 0.0, -way * vessel.lever_m * ahead), rtol=1e-6, atol=1e-9
        )


def test_debris_has_the_mass_of_its_first_class() -> None:
    model, first = loaded(FILES["debris"]), load_debris()[0]
    assert (first.name, model.nbody) == ("bottle", 2)
    assert model.body("item").mass[0] == pytest.approx(first.mass_kg, rel=1e-6)
