"""Colours of videos: vessels and items as in `style`, water and paper of their own."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mjforage.view.page import style

Colour = tuple[float, float, float]  # red, green, blue in 0..255


def from_hex(code: str) -> Colour:
    """Channels of ``#rrggbb``."""
    return float(int(code[1:3], 16)), float(int(code[3:5], 16)), float(int(code[5:7], 16))


PAGE = from_hex("#f8f6f1")
INK = from_hex(style.INK)
SOFT_INK = from_hex(style.MUTED)
HAIRLINE = from_hex("#dcd7cc")
WHITE = from_hex("#ffffff")

CLEAR_SHALLOW = from_hex("#c3eaf2")
CLEAR_DEEP = from_hex("#8ed2e8")
HAZY_SHALLOW = from_hex("#8fadc2")
HAZY_DEEP = from_hex("#7394ae")
WATER_SHADOW = from_hex("#1d4a66")
QUAY = from_hex("#d9cfbd")
QUAY_EDGE = from_hex("#fffaf0")
QUAY_FOOT = from_hex("#5d6b72")

DEEP_SEA = from_hex("#2a7d94")  # as MuJoCo's pictures show it
BODY = from_hex("#e0b800")  # of debris there
SCOUT = from_hex(style.SCOUT)
FORAGER = from_hex(style.FORAGER)
ITEM = from_hex(style.ITEM)
ITEM_RIM = from_hex(style.ITEM_RIM)
LOST = from_hex(style.LOST)


_BELIEF_RAMP: NDArray[np.float64] = (
    255.0 * style.belief_colours()(np.linspace(style.FIRST, 1.0, 12))[:, :3]
)


def agent_colours(collects: Sequence[bool]) -> list[Colour]:
    """Return one colour per agent, the same as in the report."""
    return [from_hex(code) for code in style.agent_colours(map(style.role, collects))]


LEAST_MOST = 4  # the count that is drawn darkest, where no belief is larger


def most_believed(*beliefs: NDArray[np.integer]) -> int:
    """The count that is drawn darkest in episodes, as in the replay: the largest, at least so."""
    return max(LEAST_MOST, *(int(belief.max(initial=0)) for belief in beliefs))


def belief_shades(count: NDArray[np.integer], most: int) -> NDArray[np.float64]:
    """Colours (n, 3) of believed counts (n,) over 0, by their logarithm up to that of `most`."""
    place = np.log(np.minimum(count, most)) / np.log(most)
    shades: NDArray[np.float64] = _BELIEF_RAMP[np.rint(place * (len(_BELIEF_RAMP) - 1)).astype(int)]
    return shades
