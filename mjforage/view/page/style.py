"""Style of everything drawn: colours per policy, line styles per world, and colours of things.

What is in the world has the same colour in figures, replays, films and plots, all from here: items
are pale yellow with a dark rim, beliefs indigo, agents have the hue of their role.

The policy colours were searched for until every two were 25 apart in CIELAB for normal eyes and
under each of the three colour deficiencies (a test simulates them); every policy has a marker
besides. All colours are ``#rrggbb``.
"""

import zlib
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from matplotlib.colors import LinearSegmentedColormap, ListedColormap, to_rgb

POLICY_COLOURS: dict[str, str] = {
    "ddqn": "#601860",
    "ddqn-reward": "#A76687",
    "ddqn-link": "#9E91FA",
    "mappo": "#93D26E",
    "greedy": "#0A06FD",
    "levy": "#802E09",
    "belief": "#409252",
    "auction": "#A54BFF",
    "dec-mcts": "#BC2FAB",
    "oracle": "#111111",
    "pso": "#88880E",
    "wanderer": "#DAAFE2",
    "lawnmower": "#5800A2",
    "random": "#384C3C",
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
"""Colours for policies that a user registered under a name of their own."""

MARKERS = (
    *("o", "s", "P", "$♥$", "^", "v", "D", "d"),
    *("$▬$", "X", "<", ">", "p", "h"),
)
"""Markers of the policies that ship, in their order; others take the remaining ones."""

Line = Literal["-", "--", ":", "-."]

WORLD_LINES: dict[str, Line] = {"graph": "-", "physics": "--"}
FALLBACK_LINES: tuple[Line, ...] = (":", "-.")

WATER = "#D8EAF4"
LAND = "#E3DACB"
QUAY_EDGE = "#B9AB94"
ITEM = "#FFF3A3"  # always with its rim, which is what shows on light water
ITEM_RIM = "#46210F"
BELIEF = "#3B1F8F"  # items that somebody believes in
LOST = "#D90429"  # scans that a link lost
INK = "#1F2933"
MUTED = "#66727F"
GRID = "#E4E8EC"

Role = Literal["scout", "forager"]

ROLE_SHADES: dict[str, tuple[str, ...]] = {
    "scout": ("#F08C00", "#B35900", "#FFB84D", "#7A3E00"),
    "forager": ("#C2255C", "#7D0F3B", "#EF7FA8", "#4D0824"),
}
"""Hull and track colours of the agents of a role, in the order in which they are given out."""

OTHER_SHADES: tuple[tuple[str, ...], ...] = (
    ("#00796B", "#004D40", "#4DB6AC", "#00332C"),
    ("#5D6D1E", "#3A4510", "#9CAB4C", "#232B06"),
    ("#37474F", "#1C262B", "#78909C", "#0D1214"),
)
"""Shades for roles yet to come, by name."""

SCOUT = ROLE_SHADES["scout"][0]
FORAGER = ROLE_SHADES["forager"][0]
SCOUT_VIEW = "#FBD3A0"  # water that a scout sees
FORAGER_VIEW = "#F4A6BF"

FIRST = 0.12  # place of the first stop of a ramp that is not water
RAMP_PLACES = (0.0, FIRST, 0.4, 0.7, 1.0)

RC: dict[Any, Any] = {
    "figure.autolayout": False,
    "figure.constrained_layout.use": False,  # `picture.canvas` asks for it
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
class PolicyStyle:
    """Colour and marker of one policy."""

    colour: str  # "#rrggbb"
    marker: str  # matplotlib marker code

    @property
    def dots(self) -> dict[str, Any]:
        """Keywords of matplotlib for its dots without a line between them."""
        return {"color": self.colour, "marker": self.marker, "linestyle": "none"}


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


def policy_styles(policies: Sequence[str]) -> dict[str, PolicyStyle]:
    """Give every policy a colour and a marker; unknown names share neither if avoidable.

    Returns: policy name to `PolicyStyle`, in the order of `ordered`.
    """
    names, taken = ordered(policies), set[str]()
    shapes = dict(zip(POLICY_COLOURS, MARKERS, strict=True))
    left = [marker for name, marker in shapes.items() if name not in names]
    result: dict[str, PolicyStyle] = {}
    for name in names:
        colour = policy_colour(name)
        if name not in POLICY_COLOURS:
            first = FALLBACK_COLOURS.index(colour)
            cycle = FALLBACK_COLOURS[first:] + FALLBACK_COLOURS[:first]
            colour = next((c for c in cycle if c not in taken), colour)
        taken.add(colour)
        marker = shapes.get(name) or (left.pop(0) if left else MARKERS[0])
        result[name] = PolicyStyle(colour, marker)
    return result


def world_lines(worlds: Sequence[str]) -> dict[str, Line]:
    """Matplotlib line style of every world; unknown worlds take dotted and dash-dotted lines."""
    unknown = [name for name in worlds if name not in WORLD_LINES]
    extra = {name: FALLBACK_LINES[i % len(FALLBACK_LINES)] for i, name in enumerate(unknown)}
    return {name: WORLD_LINES.get(name) or extra[name] for name in worlds}


def role(collects: bool) -> Role:
    """Role of an agent in a word, by its ability to collect; it decides the colour."""
    return "forager" if collects else "scout"


def role_shades(name: str) -> tuple[str, ...]:
    """Colours of the agents of a role; roles that are not in `ROLE_SHADES` by their checksum."""
    known = ROLE_SHADES.get(name)
    return known or OTHER_SHADES[zlib.crc32(name.encode()) % len(OTHER_SHADES)]


def agent_colours(roles: Iterable[str]) -> list[str]:
    """Hull or track colour per agent, from the shades of its role."""
    seen: Counter[str] = Counter()
    colours = []
    for name in roles:
        shades = role_shades(name)
        colours.append(shades[seen[name] % len(shades)])
        seen[name] += 1
    return colours


def map_colours() -> ListedColormap:
    """Two colours for an image of the navigable mask: 0 quay, 1 water."""
    return ListedColormap([LAND, WATER], name="port")


def item_colours() -> LinearSegmentedColormap:
    """Sequential map for items per node: water for none, then an item's yellow to its rim."""
    return _ramp("items", (WATER, "#FFE566", "#DD9F33", "#96541C", ITEM_RIM))


def belief_colours() -> LinearSegmentedColormap:
    """Sequential map for believed items per node: water for none, then to indigo and beyond."""
    return _ramp("beliefs", (WATER, "#B7A9E8", "#7F66CC", BELIEF, "#180A45"))


def _ramp(name: str, stops: Sequence[str]) -> LinearSegmentedColormap:
    """A map of five stops; at `FIRST` there is anything at all."""
    pairs = [(place, to_rgb(stop)) for place, stop in zip(RAMP_PLACES, stops, strict=True)]
    return LinearSegmentedColormap.from_list(name, pairs)
