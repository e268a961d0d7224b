import itertools

import pytest
from matplotlib.colors import to_rgb

from mjforage.view.page import style


def test_colours_do_not_depend_on_company() -> None:
    alone = style.looks(["levy"])["levy"].colour
    assert style.looks(["mine", "greedy", "levy"])["levy"].colour == alone
    assert style.looks(["mine"])["mine"].colour == style.policy_colour("mine")


def test_order_is_fixed_and_unknown_names_come_last() -> None:
    assert style.ordered(["zebra", "levy", "ape", "greedy"]) == ("greedy", "levy", "zebra", "ape")


def test_shipped_and_unknown_policies_have_distinct_colours() -> None:
    unknown = [f"own-{i}" for i in range(len(style.FALLBACK_COLOURS))]
    looks = style.looks([*style.POLICY_COLOURS, *unknown])
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
    colours = style.agent_colours([False, False, True, True])
    assert len(set(colours)) == 4
    assert set(colours[:2]) <= set(style.SCOUT_SHADES)
