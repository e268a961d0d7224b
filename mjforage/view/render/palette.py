"""Colours of films: what is in the world as everywhere (`style`), water and paper of their own."""

from collections.abc import Sequence

from mjforage.view.page import style

Colour = tuple[float, float, float]  # red, green, blue in 0..255


def _hex(code: str) -> Colour:
    return float(int(code[1:3], 16)), float(int(code[3:5], 16)), float(int(code[5:7], 16))


PAGE = _hex("#f8f6f1")
INK = _hex(style.INK)
SOFT_INK = _hex(style.MUTED)
HAIRLINE = _hex("#dcd7cc")
WHITE = _hex("#ffffff")

CLEAR_SHALLOW = _hex("#c3eaf2")
CLEAR_DEEP = _hex("#8ed2e8")
HAZY_SHALLOW = _hex("#8fadc2")
HAZY_DEEP = _hex("#7394ae")
WATER_SHADOW = _hex("#1d4a66")
QUAY = _hex("#d9cfbd")
QUAY_EDGE = _hex("#fffaf0")
QUAY_FOOT = _hex("#5d6b72")

ITEM = _hex(style.ITEM)
ITEM_RIM = _hex(style.ITEM_RIM)
BELIEF = _hex(style.BELIEF)
LOST = _hex(style.LOST)


def team_colours(collects: Sequence[bool]) -> list[Colour]:
    """Return one colour per team, from the hull colours of the report."""
    return [_hex(code) for code in style.agent_colours(map(style.role, collects))]
