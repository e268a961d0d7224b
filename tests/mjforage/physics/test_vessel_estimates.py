"""Vessels that are estimated from five numbers."""

import tomllib
from pathlib import Path
from typing import Any

import pytest

from mjforage.base.errors import UserError
from mjforage.physics.manoeuvre import key_figures, manoeuvre
from mjforage.physics.vessel_estimates import estimate_vessel
from mjforage.physics.vessels import Vessel, load_vessel

KNOWN = {"otter": (2.0, 1.08, 80.0, 239.4, 3.09), "scout": (1.35, 0.98, 36.0, 67.2, 1.97)}
CLOSE = (
    *("draft_m", "inertia_z_kgm2", "added_mass_surge_kg", "added_mass_sway_kg", "lever_m"),
    *("added_mass_yaw_kgm2", "linear_sway", "power.motor_w", "power.propeller_m", "lag_s"),
)


def written(path: Path, *numbers: float) -> Vessel:
    """The vessel of five numbers, read as any file is."""
    path.write_text(estimate_vessel(*numbers), encoding="utf-8")
    return load_vessel(path)


def value(vessel: Any, key: str) -> float:
    for part in key.split("."):
        vessel = getattr(vessel, part)
    return float(vessel)


@pytest.mark.parametrize("name", KNOWN)
def test_an_estimate_is_near_the_boat_it_was_made_of(name: str, tmp_path: Path) -> None:
    known, found = load_vessel(name), written(tmp_path / "boat.toml", *KNOWN[name])
    for key in CLOSE:
        assert value(found, key) == pytest.approx(value(known, key), rel=0.5), key
    assert found.thruster.thrust_range == pytest.approx(known.thruster.thrust_range, rel=0.05)


@pytest.mark.parametrize(
    "numbers", [*KNOWN.values(), (2.0, 1.0, 60.0, 50.0, 1.5), (0.6, 0.4, 6.0, 10.0, 1.2)]
)
def test_the_boat_makes_its_top_speed_in_mujoco(numbers: tuple[float, ...], tmp_path: Path) -> None:
    written(tmp_path / "boat.toml", *numbers)
    figures = key_figures(manoeuvre(str(tmp_path / "boat.toml"), test="straight"))
    assert figures["top_speed"].value == pytest.approx(numbers[-1], rel=0.01)


def test_every_number_that_was_not_given_says_how_it_was_made() -> None:
    tree = tomllib.loads(estimate_vessel(2.0, 1.0, 60.0, 50.0, 1.5))
    tables = [tree, *(one for one in tree.values() if isinstance(one, dict) and "unit" not in one)]
    entries = {
        key: one["source"]
        for table in tables
        for key, one in table.items()
        if isinstance(one, dict) and "unit" in one
    }
    given = {key for key, source in entries.items() if source.startswith("given")}
    assert given == {"length_m", "beam_m", "mass_kg", "max_ahead_newton"}
    rules = ("estimate: ", "Blendermann", "none: ", "from mass, drag, thrust")
    assert all(entries[key].startswith(rules) for key in {*entries} - given)


def test_numbers_that_no_boat_has_are_one_line() -> None:
    for numbers, words in (
        ((2.0, 1.0, 60.0, 50.0, 0.0), "top-speed = 0: out of range"),
        ((2.0, 1.0, -1.0, 50.0, 1.0), "mass = -1: out of range"),
        ((float("nan"), 1.0, 6.0, 50.0, 1.0), "length = nan: out of range"),
        (
            (2000.0, 1.0, 6.0, 50.0, 1.0),
            r"^length / beam = 2e\+03: these rules are for boats of 0.8",
        ),
        ((2.0, 1.0, 9e5, 50.0, 1.0), r"^draught / beam, .* = 2.2e\+03: "),
        ((2.0, 1.0, 1.0, 3.0, 1.5), r"^draught / beam, .* = 0.00244: these rules are for boats of"),
        ((2.0, 1.0, 60.0, 5000.0, 1.5), "^thrust / mass .* = 83.3: these rules .* 0.01 to 9.81"),
        ((0.1, 0.06, 0.05, 0.2, 3.0), r"^Froude number, .* = 3.03: .* 0.01 to 1.5; check the numb"),
    ):
        with pytest.raises(UserError, match=words):
            estimate_vessel(*numbers)
