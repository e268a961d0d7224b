import itertools

import pytest
from matplotlib.colors import Colormap, to_hex, to_rgb

from mjforage.view.page import style


def test_colours_do_not_depend_on_company() -> None:
    alone = style.policy_styles(["levy"])["levy"].colour
    assert style.policy_styles(["mine", "greedy", "levy"])["levy"].colour == alone
    assert style.policy_styles(["mine"])["mine"].colour == style.policy_colour("mine")


def test_order_is_fixed_and_unknown_names_come_last() -> None:
    assert style.ordered(["zebra", "levy", "ape", "greedy"]) == ("greedy", "levy", "zebra", "ape")


def test_shipped_and_unknown_policies_have_distinct_colours() -> None:
    unknown = [f"own-{i}" for i in range(len(style.FALLBACK_COLOURS))]
    looks = style.policy_styles([*style.POLICY_COLOURS, *unknown])
    assert len({look.colour for look in looks.values()}) == len(looks)


# Viénot, Brettel and Mollon 1999, "Digital video colourmaps for checking the legibility of displays
# by dichromats": linear RGB of a deuteranope and of a protanope.
DEUTERANOPE = ((0.29275, 0.70725, 0.0), (0.29275, 0.70725, 0.0), (-0.02234, 0.02234, 1.0))
PROTANOPE = ((0.11238, 0.88762, 0.0), (0.11238, 0.88762, 0.0), (0.00401, -0.00401, 1.0))


def seen(colour: str, matrix: tuple[tuple[float, ...], ...]) -> list[float]:
    linear = [channel**2.2 for channel in to_rgb(colour)]
    mixed = (sum(m * c for m, c in zip(row, linear, strict=True)) for row in matrix)
    return [max(0.0, value) ** (1 / 2.2) for value in mixed]


@pytest.mark.parametrize("matrix", [DEUTERANOPE, PROTANOPE])
def test_policies_stay_apart_for_dichromats(matrix: tuple[tuple[float, ...], ...]) -> None:
    for (a, first), (b, second) in itertools.combinations(style.POLICY_COLOURS.items(), 2):
        pair = zip(seen(first, matrix), seen(second, matrix), strict=True)
        assert sum((x - y) ** 2 for x, y in pair) ** 0.5 > 0.15, f"{a} and {b} look alike"


def test_worlds_have_distinct_lines() -> None:
    lines = style.world_lines(["graph", "physics", "tank"])
    assert len(set(lines.values())) == 3
    assert lines["graph"] == "-"


def test_agent_colours_tell_roles_apart() -> None:
    colours = style.agent_colours(["scout", "scout", "forager", "tender"])
    assert len(set(colours)) == 4
    assert set(colours[:2]) <= set(style.ROLE_SHADES["scout"])
    assert colours[3] not in {s for shades in style.ROLE_SHADES.values() for s in shades}


def test_the_colour_of_a_role_does_not_depend_on_company() -> None:
    assert style.agent_colours(["tender"]) == style.agent_colours(["scout", "tender"])[1:]


def distance(first: str, second: str, matrix: tuple[tuple[float, ...], ...]) -> float:
    pair = zip(seen(first, matrix), seen(second, matrix), strict=True)
    return float(sum((x - y) ** 2 for x, y in pair) ** 0.5)


@pytest.mark.parametrize("matrix", [DEUTERANOPE, PROTANOPE])
def test_what_is_in_the_world_stays_apart_for_dichromats(
    matrix: tuple[tuple[float, ...], ...],
) -> None:
    signs = (style.SCOUT, style.FORAGER, style.ITEM_RIM, style.BELIEF)
    for first, second in itertools.combinations((*signs, style.WATER, style.ITEM), 2):
        if {first, second} != {style.WATER, style.ITEM}:  # which the rim keeps apart
            assert distance(first, second, matrix) > 0.15, f"{first} and {second} look alike"


@pytest.mark.parametrize("ramp", [style.item_colours(), style.belief_colours()])
def test_one_item_shows_on_water_and_more_are_darker(ramp: Colormap) -> None:
    shades = [to_hex(ramp(place)) for place in (style.FIRST, 0.4, 0.7, 1.0)]
    for matrix in (DEUTERANOPE, PROTANOPE):
        assert distance(style.WATER, shades[0], matrix) > 0.15
    light = [sum(to_rgb(shade)) for shade in shades]
    assert light == sorted(light, reverse=True)
