from pathlib import Path

import pytest

from mjforage.base.errors import UserError
from mjforage.physics.scene import DebrisClass, load_debris
from mjforage.scenario.assets import models_folder

CLASSES = load_debris()
TEXT = (models_folder() / "debris.toml").read_text()


@pytest.mark.parametrize("kind", CLASSES, ids=lambda kind: kind.name)
def test_response_takes_0_2_to_1_4_s_in_the_default_wind(kind: DebrisClass) -> None:
    assert 0.2 <= kind.response_s(2.0) <= 1.4


def test_leeway_follows_the_square_root_law() -> None:
    kind = DebrisClass("x", "", 1.0, 0.0, 0.02, 0.04, 1.2, 0.6, 0.0, 1.0)
    k = (1.224 * 1.2 * 0.02 / (1025.0 * 0.6 * 0.04)) ** 0.5
    assert kind.leeway == pytest.approx(k / (1.0 + k), rel=1e-12)


def test_the_papers_item_drifts_at_3_percent() -> None:
    paper = next(kind for kind in CLASSES if kind.name == "drifter")
    assert paper.leeway == pytest.approx(0.03, abs=1e-7)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            'value = 0.03, unit = "kg"',
            'value = -0.03, unit = "kg"',
            "mass_kg = -0.03 should be greater than 0",
        ),
        ('value = 0.03, unit = "kg"', 'value = 0.03, unit = "g"', 'expected "kg"'),
        ('value = 0.03, unit = "kg"', 'value = "a", unit = "kg"', "should be a valid number"),
        (
            'value = 0.03, unit = "kg"',
            'value = 0, unit = "kg"',
            "mass_kg = 0 should be ",
        ),
        (
            'value = 0.04, unit = "1"',
            'value = 0.06, unit = "1"',
            "leeway_low = 0.06 is above leeway",
        ),
        (
            'value = 0.04, unit = "1"',
            'value = 0.047, unit = "1"',
            "bottle: leeway 0.04499 of the wind lies outside 0.047 to 0.05; change areas or drags",
        ),
        ("drag_air", "drag_of_air", "bottle: unknown key drag_of_air; did you mean drag_air?"),
        ("[bottle]", "[bottle", "not readable as TOML"),
        (TEXT, "", "no class"),
    ],
)
def test_bad_files_are_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(TEXT.replace(old, new))
    with pytest.raises(UserError, match=r"debris mine.toml.*") as caught:
        load_debris(file)
    assert message in str(caught.value)
