from pathlib import Path

import pytest

from mjforage.base.errors import UserError
from mjforage.physics.vessels import (
    ForceThruster,
    Vessel,
    load_vessel,
)
from mjforage.scenario.assets import models_folder
from mjforage.scenario.schema import rows
from mjforage.scenario.vessel_files import vessel_names

GOOD = """
description = "a raft"
length_m = { value = 2, unit = "m", source = "test" }
beam_m = { value = 1.0, unit = "m", source = "test" }
draft_m = { value = 0.2, unit = "m", source = "test" }
mass_kg = { value = 50.0, unit = "kg", source = "test" }
cog_x_m = { value = 0.1, unit = "m", source = "test" }
inertia_z_kgm2 = { value = 9.0, unit = "kg m2", source = "test" }
added_mass_surge_kg = { value = 5.0, unit = "kg", source = "test" }
added_mass_sway_kg = { value = 40.0, unit = "kg", source = "test" }
added_mass_yaw_kgm2 = { value = 6.0, unit = "kg m2", source = "test" }
linear_surge = { value = 20.0, unit = "N s/m", source = "test" }
linear_sway = { value = 50.0, unit = "N s/m", source = "test" }
linear_yaw = { value = 9.0, unit = "N m s", source = "test" }
quadratic_surge = { value = 0.0, unit = "N s2/m2", source = "test" }
quadratic_sway = { value = 0.0, unit = "N s2/m2", source = "test" }
quadratic_yaw = { value = 0.0, unit = "N m s2", source = "test" }
yaw_linear_growth = { value = 0.0, unit = "s", source = "test" }
lever_m = { value = 0.4, unit = "m", source = "test" }
lag_s = { value = 0.1, unit = "s", source = "test" }
[thruster]
kind = "force"
max_ahead_newton = { value = 20.0, unit = "N", source = "test" }
max_astern_newton = { value = 10.0, unit = "N", source = "test" }
dead_zone_newton = { value = 0.0, unit = "N", source = "test" }
"""


def load(folder: Path, text: str) -> Vessel:
    path = folder / "raft.toml"
    path.write_text(text, encoding="utf-8")
    return load_vessel(path)


def changed(key: str, value: str) -> str:
    """GOOD with another value of one key."""
    lines = [line for line in GOOD.splitlines() if not line.startswith(f"{key} =")]
    old = next(line for line in GOOD.splitlines() if line.startswith(f"{key} ="))
    before, after = old.split("value = ")[0], old.split(",", 1)[1]
    place = GOOD.splitlines().index(old)
    lines.insert(place, f"{before}value = {value},{after}")
    return "\n".join(lines)


def test_every_vessel_file_is_listed() -> None:
    files = (models_folder() / "vessels").iterdir()
    names = [file.stem for file in files if not file.name.endswith(".capture.toml")]
    assert vessel_names() == sorted(names)
    assert {"forager", "ideal", "otter", "scout"} <= set(names)


def test_a_file_of_ones_own_loads(tmp_path: Path) -> None:
    raft = load(tmp_path, GOOD)
    assert raft.name == "raft"
    assert raft.length_m == 2.0
    assert isinstance(raft.length_m, float)
    assert raft.crossflow is None
    assert raft.windage.area_side_m2 == 0.0
    assert raft.thruster == ForceThruster(20.0, 10.0, 0.0)
    assert raft.control is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (changed("mass_kg", "-50.0"), "mass_kg = -50.0 should be "),
        (changed("mass_kg", "nan"), "mass_kg = nan should be "),
        (changed("linear_sway", "-1"), "linear_sway = -1 should be "),
        (changed("max_ahead_newton", "0.0"), "thruster.max_ahead_newton = 0.0 should be "),
        (changed("inertia_z_kgm2", "0.5"), "about midships; raise inertia_z_kgm2 or bring"),
        (changed("cog_x_m", "0.6"), "is indefinite inertia"),
        (
            changed("cog_x_m", "1.0").replace("value = 9.0", "value = 99.0", 1),
            "cog_x_m = 1 is outside the vessel of 2 m",
        ),
        (changed("linear_yaw", "0"), "no damping in yaw; give linear_yaw or quadratic_yaw"),
        (changed("dead_zone_newton", "10.0"), "dead_zone_newton = 10 leaves no thrust"),
        (GOOD.replace('unit = "kg",', 'unit = "lb",'), "mass_kg has unit 'lb', expected \"kg\""),
        (GOOD.replace(', source = "test" }\nbeam', " }\nbeam"), "length_m has value, unit; give"),
        (GOOD.replace('"test" }\nbeam', '" " }\nbeam'), "length_m has no source; say where 2"),
        (GOOD.replace('"force"', '"sail"'), "thruster.kind = 'sail'; choose propeller, force"),
        (GOOD.replace('kind = "force"\n', ""), "thruster.kind = ''; choose propeller, force"),
        (
            GOOD.replace('"force"', '"propeller"'),
            "unknown key thruster.max_ahead_newton; did you mean thruster.n_max_ahead?",
        ),
        (GOOD + "[control]\nbrake = 1\n", "unknown key control.brake; did you mean control.brake_"),
        ("mass_kg = 3\n" + GOOD.replace("mass_kg", "# mass_kg", 1), "mass_kg = 3, expected a tab"),
    ],
)  # fmt: skip
def test_errors_name_file_key_and_remedy(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(UserError) as caught:
        load(tmp_path, text)
    assert str(caught.value).startswith("vessel raft: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("oter", "neither a shipped vessel nor a TOML file; did you mean otter"),
        ("nowhere.toml", "vessel nowhere.toml: neither a shipped vessel nor a TOML file; choose"),
        ("/nowhere.toml", "/nowhere.toml: neither a shipped vessel"),
        ("a\0b.toml", "neither a shipped vessel|cannot be opened"),
    ],
)
def test_unknown_vessels_are_refused(name: str, words: str) -> None:
    with pytest.raises(UserError, match=words):
        load_vessel(name)


def test_every_number_of_a_vessel_file_has_a_unit_a_range_and_a_sentence() -> None:
    numbers = [row for row in rows(Vessel) if row.type == "a number"]
    assert len(numbers) > 50
    for row in numbers:
        assert row.unit, row.key
        assert row.range, row.key
        assert row.sentence, row.key
