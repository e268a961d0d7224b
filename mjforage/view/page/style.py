"""How everything drawn looks: colours per policy, line styles per world, map and hull colours.

The policy colours extend the Okabe-Ito palette (M. Okabe and K. Ito, "Color Universal Design",
2008), so that they stay apart under the common colour deficiencies; lightness and markers carry
the difference a second time. All colours are ``#rrggbb``.
"""

import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from matplotlib.colors import LinearSegmentedColormap, ListedColormap, to_rgb

POLICY_COLOURS: dict[str, str] = {
    "ddqn": "#B5308A",
    "ddqn-reward": "#E69AC0",
    "ddqn-link": "#4C0CCC",
    "greedy": "#0072B2",
    "levy": "#D55E00",
    "belief": "#009E73",
    "oracle": "#111111",
    "pso": "#E3C400",
    "wanderer": "#56B4E9",
    "lawnmower": "#5B2A86",
    "random": "#5E5E5E",
}
"""Colour of every policy that ships; the order is the order in legends and tables."""

FALLBACK_COLOURS: tuple[str, ...] = (
    "#6B8E23",
    "#8C510A",
    "#44AA99",
    "#CC6677",
    "#332288",
    "#DDB310",
    "#882255",
    "#5E7A8C",
)
"""For policies that a user registered under a name of their own."""

MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "p")

Line = Literal["-", "--", ":", "-."]

WORLD_LINES: dict[str, Line] = {"graph": "-", "physics": "--"}
FALLBACK_LINES: tuple[Line, ...] = (":", "-.")

WATER = "#D8EAF4"
LAND = "#E3DACB"
QUAY_EDGE = "#B9AB94"
ITEM = "#14532D"
SCOUT = "#F08C00"
FORAGER = "#C2255C"
LOST = "#D90429"  # looks that a link lost
SCOUT_VIEW = "#FFE08A"  # water that a scout sees
FORAGER_VIEW = "#F4A6BF"
INK = "#1F2933"
MUTED = "#66727F"
GRID = "#E4E8EC"

SCOUT_SHADES = ("#F08C00", "#C77700", "#FFB84D", "#8F5500")
FORAGER_SHADES = ("#C2255C", "#6741D9", "#E8709A", "#3B2A8C")

RC: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 11.0,
    "axes.titlesize": 11.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 11.0,
    "axes.edgecolor": "#9AA5B1",
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 10.0,
    "ytick.labelsize": 10.0,
    "text.color": INK,
    "lines.linewidth": 1.9,
    "legend.frameon": False,
    "legend.fontsize": 10.0,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "figure.dpi": 100,
    "svg.hashsalt": "mjforage",
    "svg.fonttype": "path",
    "path.simplify_threshold": 0.2,
}
"""Passed to `matplotlib.rc_context`; nothing global is changed for good."""


@dataclass(frozen=True)
class Look:
    """Colour and marker of one policy."""

    colour: str  # "#rrggbb"
    marker: str  # matplotlib marker code


def policy_colour(name: str) -> str:
    """Colour of one policy, the same in every run: by name, unknown names by their checksum."""
    known = POLICY_COLOURS.get(name)
    if known is not None:
        return known
    return FALLBACK_COLOURS[zlib.crc32(name.encode()) % len(FALLBACK_COLOURS)]


def ordered(policies: Iterable[str]) -> tuple[str, ...]:
    """Policies in the fixed order: those that ship first, then unknown ones as they came."""
    rank = {name: i for i, name in enumerate(POLICY_COLOURS)}
    unique = tuple(dict.fromkeys(policies))
    return tuple(sorted(unique, key=lambda name: rank.get(name, len(rank))))


def looks(policies: Sequence[str]) -> dict[str, Look]:
    """Give every policy a colour and a marker; two unknown names never share a colour if avoidable.

    Returns
    -------
    dict
        Policy name to `Look`, in the order of `ordered`.
    """
    taken: set[str] = set()
    result: dict[str, Look] = {}
    for i, name in enumerate(ordered(policies)):
        colour = policy_colour(name)
        if name not in POLICY_COLOURS:
            first = FALLBACK_COLOURS.index(colour)
            cycle = FALLBACK_COLOURS[first:] + FALLBACK_COLOURS[:first]
            colour = next((c for c in cycle if c not in taken), colour)
        taken.add(colour)
        result[name] = Look(colour, MARKERS[i % len(MARKERS)])
    return result


def world_lines(worlds: Sequence[str]) -> dict[str, Line]:
    """Matplotlib line style of every world; unknown worlds take dotted and dash-dotted lines."""
    unknown = [name for name in worlds if name not in WORLD_LINES]
    extra = {name: FALLBACK_LINES[i % len(FALLBACK_LINES)] for i, name in enumerate(unknown)}
    return {name: WORLD_LINES.get(name) or extra[name] for name in worlds}


def agent_colours(collects: Sequence[bool]) -> list[str]:
    """Hull or track colour per agent: scouts in oranges, foragers in magenta and violet."""
    seen = {False: 0, True: 0}
    colours = []
    for collector in collects:
        shades = FORAGER_SHADES if collector else SCOUT_SHADES
        colours.append(shades[seen[collector] % len(shades)])
        seen[collector] += 1
    return colours


def map_colours() -> ListedColormap:
    """Two colours for an image of the navigable mask: 0 quay, 1 water."""
    return ListedColormap([LAND, WATER], name="port")


def item_colours() -> LinearSegmentedColormap:
    """Sequential map for items per node: water for none, then yellow through red to near black."""
    stops = [WATER, "#FFD166", "#F58A2E", "#D1342F", "#6A0F2A"]
    places = [0.0, 0.12, 0.4, 0.7, 1.0]
    pairs = [(place, to_rgb(stop)) for place, stop in zip(places, stops, strict=True)]
    return LinearSegmentedColormap.from_list("items", pairs)
