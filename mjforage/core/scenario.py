"""What a mission is: frozen dataclasses, one per table of a scenario file, with units and ranges.

`mjforage.core.scenario_file` reads them from strict TOML. Sources: paper, section "Foraging
Environment" and "Items Dynamics"; numbers of the published code where the paper gives none.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from graph_planner.belief_settings import BeliefSettings
from graph_planner.fleet import Role


def bounded(low: float, high: float) -> dict[str, float]:
    """Field metadata: the closed range of a number."""
    return {"low": low, "high": high}


def one_of(*choices: str) -> dict[str, tuple[str, ...]]:
    """Field metadata: the words that a text can be."""
    return {"choices": choices}


@dataclass(frozen=True)
class MapChoice:
    """`[map]`: the grid, how it becomes a graph, and where agents start."""

    file: str  # name of a shipped map, or path of a CSV file or image
    pitch_m: float = field(default=4.0, metadata=bounded(1e-3, 1e6))  # between node centres [m]
    corner_cutting: bool = False  # may diagonals cut corners
    largest_component: bool = False  # keep only the largest connected part of the map
    starts: tuple[tuple[int, int], ...] | None = None
    """(row, column) to assign at random; absent: those beside the map; []: a random cluster."""


@dataclass(frozen=True)
class Rules:
    """`[rules]`: what agents may do in a decision."""

    stay: bool = True  # staying put is an action
    shorten: bool = True  # a blocked longer move ends before the obstacle instead of being illegal
    order: tuple[str, ...] = ()
    """All teams as they choose, in each the highest number first; empty: those that collect, then
    the others, each by name."""


@dataclass(frozen=True)
class Items:
    """`[items]`: how many items float around how wide a hotspot."""

    mean: float = field(default=75.0, metadata=bounded(0, 20_000))  # number of items, mean
    std: float = field(default=10.0, metadata=bounded(0, 2_000))  # number of items, deviation
    covariance_node2: float = field(default=20.0, metadata=bounded(0, 1e9))  # per axis [node^2]
    hotspots: int = field(default=1, metadata=bounded(1, 100))  # clusters, items dealt out in turn


@dataclass(frozen=True)
class Weather:
    """`[weather]`: the paper's drift in every world; gusts and currents in the physics world.

    The physics world makes the drift by a wind of drift / 0.03, which hulls feel too.
    """

    drift_node_per_step: float = field(
        default=0.1, metadata=bounded(0, 10)
    )  # uniform in +- per axis
    noise_node_per_step: float = field(
        default=0.09, metadata=bounded(0, 10)
    )  # uniform in +- per axis
    gust_intensity: float = field(default=0.0, metadata=bounded(0, 0.5))
    """Standard deviation of the gusts along the wind, over its speed; 0.1-0.2 is usual."""
    gust_tau_s: float = field(default=2.0, metadata=bounded(1e-2, 1e4))  # their correlation time
    current_speed_mps: float = field(default=0.0, metadata=bounded(0, 5))  # constant current
    current_toward_deg: float | None = field(default=None, metadata=bounded(-360, 360))
    """Where it flows to, counter-clockwise from east; absent: drawn per episode."""
    current_wander_mps: float = field(default=0.0, metadata=bounded(0, 5))
    """Standard deviation per axis of a slow Gauss-Markov current."""
    circulation_mps: float = field(default=0.0, metadata=bounded(-5, 5))
    """Peak speed of a harbour circulation between the quays, positive counter-clockwise."""


@dataclass(frozen=True)
class Physics:
    """`[physics]`: how the MuJoCo world carries decisions out."""

    vessels: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    """Team -> vessel (a name or a TOML file); absent: `forager` if it collects, else `scout`."""
    capture: str = field(default="node", metadata=one_of("node", "intake"))
    """`node`: all items in the hull's node at the end of a decision; `intake`: an item that enters
    the mouth at the bow."""
    items: str = field(default="bodies", metadata=one_of("bodies", "graph"))
    """`bodies` that wind and water move, or moved by the rule of the graph world."""
    item_classes: tuple[str, ...] = ("drifter",)  # of `models/debris.toml`, one drawn per item
    integrator: str = field(default="fast", metadata=one_of("fast", "reference"))
    step_s: float = field(default=0.1, metadata=bounded(1e-3, 0.1))  # of the integrator


@dataclass(frozen=True)
class Sensors:
    """`[sensors]`: what measurements lack in the physics world; nothing by default."""

    position_noise_m: float = field(default=0.0, metadata=bounded(0, 2))  # deviation per axis
    heading_noise_deg: float = field(default=0.0, metadata=bounded(0, 20))  # deviation
    detection: float = field(default=1.0, metadata=bounded(0, 1))
    """Probability that an item in view is seen, drawn per item and decision."""


@dataclass(frozen=True)
class CorruptionChoice:
    """`[corruption]`: a team whose actions are partly random (CSSC)."""

    team: str = ""  # name of the corrupted team; empty: nobody
    epsilon: float = field(default=0.0, metadata=bounded(0, 1))  # probability per decision
    whole_team: bool = False  # the published code's variant: one draw for the team


@dataclass(frozen=True)
class Scenario:
    """A mission: everything that decides an episode, apart from seed, policy and world."""

    name: str
    map: MapChoice
    team: Mapping[str, Role]  # in the order of the file, which numbers the agents
    description: str = ""
    horizon: int = field(default=150, metadata=bounded(1, 30000))  # decisions (the paper's T)
    period_s: float = field(default=10.0, metadata=bounded(1e-3, 1e6))  # one decision [s]
    rules: Rules = Rules()
    items: Items = Items()
    weather: Weather = Weather()
    physics: Physics = Physics()
    sensors: Sensors = Sensors()
    corruption: CorruptionChoice = CorruptionChoice()
    belief: BeliefSettings = field(
        default_factory=BeliefSettings
    )  # the policy `belief`'s own assumptions
