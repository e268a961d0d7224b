"""Policies are told apart by colour with any of the three colour deficiencies, and without.

Deficiencies are simulated after G. M. Machado, M. M. Oliveira and L. A. F. Fernandes, "A
Physiologically-based Model for Simulation of Color Vision Deficiency", IEEE TVCG 15(6), 2009:
their matrices of severity 1.0, on linear RGB.
"""

import itertools

import numpy as np
import pytest
from matplotlib.colors import Colormap, to_hex, to_rgb
from numpy.typing import NDArray

from mjforage.view.page import style

EYES = {
    "normal": np.eye(3),
    "protanopia": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deuteranopia": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
    "tritanopia": np.array(
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ]
    ),
}
TO_XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)  # sRGB, D65
WHITE = np.array([0.95047, 1.0, 1.08883])
APART = 25.0  # CIELAB 1976
DARKEST = 20.0  # lightness of a chip that still shows on a dark page, the oracle's black aside
LIGHTEST = 80.0  # of a line on white


def lab(colour: str, eyes: str = "normal") -> NDArray[np.float64]:
    """CIELAB of a colour as these eyes see it."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    xyz = TO_XYZ @ np.clip(EYES[eyes] @ linear, 0.0, 1.0) / WHITE
    f = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def test_the_simulation_knows_who_confuses_what() -> None:
    """Red and green of one lightness look alike to deuteranopes, not to tritanopes."""
    red, green = "#C06060", "#60803A"
    far = {
        eyes: float(np.linalg.norm(lab(red, eyes) - lab(green, eyes)))
        for eyes in ("normal", "deuteranopia", "tritanopia")
    }
    assert far["deuteranopia"] < 0.4 * far["normal"] < far["tritanopia"]


@pytest.mark.parametrize("eyes", EYES)
def test_colours_of_any_two_policies_are_told_apart(eyes: str) -> None:
    colours = style.POLICY_COLOURS
    for one, other in itertools.combinations(colours, 2):
        far = float(np.linalg.norm(lab(colours[one], eyes) - lab(colours[other], eyes)))
        assert far >= APART, f"{one} and {other} are {far:.1f} apart"


def test_colours_show_on_white_and_on_dark() -> None:
    for name, colour in style.POLICY_COLOURS.items():
        assert name == "oracle" or lab(colour)[0] > DARKEST, name
        assert lab(colour)[0] < LIGHTEST, name


def test_every_policy_has_a_marker_of_its_own_in_every_figure() -> None:
    together = style.policy_styles(list(style.POLICY_COLOURS))
    assert len({look.marker for look in together.values()}) == len(together)
    for name, look in together.items():
        assert style.policy_styles([name])[name] == look


def test_policies_of_others_take_markers_that_are_left() -> None:
    looks = style.policy_styles(["greedy", "levy", "mine", "yours"])
    assert len({look.marker for look in looks.values()}) == 4


def apart(one: str, other: str, eyes: str) -> float:
    return float(np.linalg.norm(lab(one, eyes) - lab(other, eyes)))


@pytest.mark.parametrize("eyes", EYES)
def test_what_is_in_the_world_stays_apart(eyes: str) -> None:
    signs = (style.SCOUT, style.FORAGER, style.ITEM_RIM, style.BELIEF, style.WATER, style.ITEM)
    for one, other in itertools.combinations(signs, 2):
        if {one, other} != {style.WATER, style.ITEM}:  # which the rim keeps apart
            assert apart(one, other, eyes) > 15.0, f"{one} and {other} look alike"


@pytest.mark.parametrize("ramp", [style.item_colours(), style.belief_colours()])
def test_one_item_shows_on_water_and_more_are_darker(ramp: Colormap) -> None:
    shades = [to_hex(ramp(place)) for place in (style.FIRST, 0.4, 0.7, 1.0)]
    assert min(apart(style.WATER, shades[0], eyes) for eyes in EYES) > 15.0
    light = [sum(to_rgb(shade)) for shade in shades]
    assert light == sorted(light, reverse=True)
