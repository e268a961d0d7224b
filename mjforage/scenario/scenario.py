"""The schema of a scenario file: frozen dataclasses, one per table of a scenario file.

They are the schema of the file (see `mjforage.scenario.schema`). Sources: paper, sections "Foraging
Environment" and "Items Dynamics"; numbers of the published code where the paper gives none.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Annotated, Literal

from mjforage.base.fields import Above, Within, source
from mjforage.scenario.bearings import Bearing
from mjforage.scenario.faults import Faults
from mjforage.scenario.link import Link
from mjforage.scenario.prior import Prior
from mjforage.scenario.roles import Role
from mjforage.scenario.sensors import Sensors

_Cell = Annotated[int, Within(-(2**63), 2**63 - 1)]  # of a grid; the map says which there are
_Latitude = Annotated[float, Within(-90, 90, "deg")]
_Longitude = Annotated[float, Within(-180, 180, "deg")]


@dataclass(frozen=True)
class MapChoice:
    """The grid, the rules of its graph, and the start nodes of the agents."""

    file: str
    """Name of a shipped map or a generated harbour (`harbour:combs:7`), or path of a table, grid,
    image or place (a folder of `mjforage place`) from the scenario's folder."""
    pitch_m: Annotated[float, Within(1e-3, 1e6, "m")] = 4.0
    """Distance between the centres of neighbouring nodes; a place has its own."""
    corner_cutting: bool = False
    """True: diagonal moves may cut corners of the land."""
    largest_component: bool = False
    """True: only the largest connected part of the map is used."""
    starts: tuple[tuple[_Cell, _Cell], ...] | None = None
    """(row, column) to assign at random; absent: those beside the map; []: a random cluster."""
    starts_latlon: tuple[tuple[_Latitude, _Longitude], ...] = ()
    """(latitude, longitude) of the starts on a place, in the place of `starts`."""
    water_level_m: Annotated[float, Within(-20, 20, "m")] = 0.0
    """Height of the tide above the datum of a place's depths, for `team.NAME.draught_m`."""
    water: Literal["light", "dark"] = "light"
    """Cells of a file that are water: `light` pixels of an image, 1 of a table; or `dark`, 0."""


@dataclass(frozen=True)
class Rules:
    """Rules of a decision: actions, boundary condition, capture, and order of choice."""

    stay: bool = True
    """True: staying put is an action."""
    shorten: bool = True
    """True: a blocked longer move ends before the obstacle; False: it is illegal."""
    jump: bool = False
    """True: only the end node of a move has to be free, and land on the way is crossed; in the
    graph world alone, with `shorten = false`."""
    start_seen: bool = True
    """False: what is in view at the start is believed, but unseen until the first step."""
    walls: Literal["clip", "project", "published"] = "clip"
    """Boundary condition, which puts an item on land back into the nearest node. `clip`: each
    component of its offset is cut to 0.49 node; `project`: the offset is scaled, its larger
    component to 0.49; `published`: as `project`, but the smaller component takes the sign of the
    lesser of the two signed offsets, as in the paper's code."""
    capture: Literal["certain", "calibrated"] = "certain"
    """Collection where items follow the rule: `certain`: foragers collect all items in their node;
    `calibrated`: with the capture probability of their vessels in trials (`mjforage calibrate`)."""
    sight: Literal["line", "disc"] = "line"
    """`line`: land on the straight line hides a node; `disc`: agents see across land."""
    order: tuple[str, ...] = ()
    """Teams in order of choice, in each the highest number first; empty: those that collect, then
    the others, each by name."""


@dataclass(frozen=True)
class Items:
    """Number of floating items, and number and width of their hotspots."""

    mean: Annotated[float, Within(0, 20_000, "items"), source("paper")] = 75.0
    """Mean number of items."""
    std: Annotated[float, Within(0, 2_000, "items"), source("paper")] = 10.0
    """Standard deviation of the number of items."""
    covariance_node2: Annotated[float, Within(0, 1e9, "node^2"), source("paper")] = 20.0
    """Variance of the items' places around their hotspot, per axis."""
    hotspots: Annotated[int, Within(1, 100)] = 1
    """Number of clusters; items are assigned to them in turn."""
    otherwise: Annotated[int, Within(1, 20_000, "items")] = 1
    """Number of items where the drawn number, rounded, is not positive."""


_SHEAR = source("IEC 61400-3: 0.14, about 1/7, over open water")
_Drift = Annotated[float, Within(-10, 10, "node/step")]
_Drifts = tuple[_Drift, _Drift]


@dataclass(frozen=True)
class Weather:
    """Wind or the paper's drift in every world; currents, lee and gusts where there are any.

    Wind and drift are one: the physics world makes the drift by a wind of drift / 0.03, which acts
    on vessels too, and in the graph world items drift at 0.03 of a given wind.
    """

    wind_speed_mps: Annotated[float, Within(0, 30, "m/s")] | None = None
    """Mean wind, in the place of the drift: `drift_node_per_step` then says nothing; absent: the
    wind is the drift's."""
    wind_from_deg: Bearing | None = None
    """Direction that the wind comes from, clockwise from true north (0 north, 90 east); absent:
    drawn per episode, uniform over the circle."""
    wind_spread: Annotated[float, Within(0, 1)] = 0.0
    """By what share the mean wind of an episode may differ: its speed is uniform in
    `wind_speed_mps` times 1 +- this."""
    shelter_height_m: Annotated[float, Within(0, 30, "m")] = 0.0
    """Height of obstacles on all land, in whose wind shadow the wind is weaker; 0: no shadow."""
    file: str | None = None
    """Recorded wind, current or both, from the scenario's folder: CSV, NDBC's standard
    meteorological text, or NetCDF by the CF conventions. A recorded wind takes the place of wind
    and drift, a recorded current adds to the others; both are of open water."""
    start: str | None = None
    """Time of the record at which episodes begin, ISO 8601 in UTC; absent: drawn per episode."""
    record_height_m: Annotated[float, Within(0.5, 200, "m")] | None = None
    """Height of the recorded wind above the water; absent: as the file says, else 10."""
    height_m: Annotated[float, Within(0.1, 200, "m")] = 10.0
    """Height to which a recorded wind is brought; leeways are shares of the wind at 10 m."""
    shear_exponent: Annotated[float, Within(0, 0.5), _SHEAR] = 0.14
    """Exponent a of the power law: the wind at height h is as (h / record_height_m)^a."""
    drift: Literal["constant", "forced"] | None = None
    """Drift of items that follow the rule of the graph world: `constant`: all at 0.03 of the
    mean wind; `forced`: by wind, lee and current where and when they are, each by the leeway of
    its class in `physics.item_classes`; absent: `forced` with a file, else `constant`."""
    drift_node_per_step: Annotated[float, Within(0, 10, "node/step"), source("paper")] = 0.1
    """Constant drift of an episode's items, uniform in +- this per axis; not with
    `wind_speed_mps`."""
    drift_ranges_node_per_step: tuple[_Drifts, _Drifts] | None = None
    """Ranges [least, largest] of the drift along the rows and the columns, in the place of +- that
    key."""
    noise_node_per_step: Annotated[float, Within(0, 10, "node/step"), source("paper")] = 0.09
    """Independent drift per item and step, uniform in +- this per axis."""
    gust_intensity: Annotated[float, Within(0, 0.5)] | None = None
    """Standard deviation of the gusts along the wind, over its speed (0.1-0.2 is usual); absent:
    the record's own, else 0."""
    gust_tau_s: Annotated[float, Within(1e-2, 1e4, "s")] = 2.0
    """Correlation time of the gusts."""
    current_speed_mps: Annotated[float, Within(0, 5, "m/s")] = 0.0
    """Speed of a constant current in open water. Quays let none of it through and weaken it beside
    them; in a narrows it is faster, in a bay with one mouth it ends near the mouth. Needs water at
    the map's edge, where it comes in and goes out."""
    current_to_deg: Bearing | None = None
    """Direction that it flows to, clockwise from true north (0 north, 90 east); absent: drawn per
    episode."""
    current_spread: Annotated[float, Within(0, 1)] = 0.0
    """By what share the speed of an episode's current may differ, as `wind_spread`."""
    current_wander_mps: Annotated[float, Within(0, 5, "m/s")] = 0.0
    """Standard deviation per axis of a slow Gauss-Markov part of that current."""
    circulation_mps: Annotated[float, Within(-5, 5, "m/s")] = 0.0
    """Peak speed of a harbour circulation between the quays, positive counter-clockwise."""

    @property
    def forced(self) -> bool:
        """True if wind and current carry items at graph level too."""
        return self.drift == "forced" or (self.drift is None and self.file is not None)

    def without_gusts(self) -> "Weather":
        """The same wind without gusts; itself if there are none."""
        none = self.gust_intensity == 0.0 or (self.gust_intensity is None and self.file is None)
        return self if none else replace(self, gust_intensity=0.0)

    def over_still_water(self) -> "Weather":
        """The same wind without a current."""
        return replace(self, current_speed_mps=0.0, current_wander_mps=0.0, circulation_mps=0.0)

    @property
    def drift_ranges(self) -> tuple[_Drifts, _Drifts]:
        """Ranges of the drift along rows and columns [node/step], where no wind is given."""
        reach = self.drift_node_per_step
        return self.drift_ranges_node_per_step or ((-reach, reach), (-reach, reach))


_ARCH = source("estimate: five abreast fill a mouth; silos clog up to 5, Zuriguel et al. (2005)")
_MOUTH = source("estimate: a belt of 0.2 m/s, one item of 0.2 m after the other")
_PAYLOADS = source("Heron bare, 28 of 36 kg; Otter with 45 kg of payload, 100 of 80 kg")
_RULES = source("estimate; the Otter's are rules of thumb, 1.5 m sideways and 1.7 I in yaw")
_SWAY = source("Heron, linear_sway: published 40 to 100, the file has 70")
_WORN = source("Heron: 22 to 24 N measured on a worn boat, nominal 33.6 N")
_AREAS = source("estimate, as all areas are")


@dataclass(frozen=True)
class Scale:
    """Factors on the parameters of all vessels, within the ranges left open by `models/vessels`.

    Controllers do not know them: they use the parameters of the vessels' files. A changed vessel
    that its controllers know is a vessel file of its own.
    """

    mass: Annotated[float, Within(0.78, 1.25), _PAYLOADS] = 1.0
    """Factor on mass and yaw inertia of the rigid body."""
    added_mass: Annotated[float, Within(0.5, 1.5), _RULES] = 1.0
    """Factor on the added mass of all axes."""
    drag: Annotated[float, Within(0.57, 1.43), _SWAY] = 1.0
    """Factor on linear, quadratic and cross-flow drag of all axes, without that of items aboard."""
    thrust: Annotated[float, Within(0.65, 1.0), _WORN] = 1.0
    """Factor on the thrust of propellers at any speed; on the highest thrust of other thrusters."""
    windage: Annotated[float, Within(0.5, 2.0), _AREAS] = 1.0
    """Factor on the areas that the wind meets."""


@dataclass(frozen=True)
class Spread:
    """By how much a vessel's numbers differ from one episode to the next, for randomised training.

    Each vessel of each episode draws a factor, uniform in 1 +- the key. It multiplies those of
    `physics.scale`; controllers do not know it.
    """

    mass: Annotated[float, Within(0, 0.25), _PAYLOADS] = 0.0
    """Of the factor on mass and yaw inertia of the rigid body."""
    drag: Annotated[float, Within(0, 0.43), _SWAY] = 0.0
    """Of the factor on linear, quadratic and cross-flow drag, without that of items aboard."""
    thrust: Annotated[float, Within(0, 0.35), _WORN] = 0.0
    """Of the factor on the thrust of both thrusters, at any command."""


Device = Literal["cpu", "warp-cpu", "cuda"]


@dataclass(frozen=True)
class Physics:
    """Settings of the MuJoCo world."""

    vessels: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    """Team -> vessel (a name, or a TOML file from the scenario's folder); absent: `forager` if it
    collects, else `scout`."""
    capture: Literal["node", "intake"] = "node"
    """`node`: all items in the hull's node at the end of a decision; `intake`: an item that enters
    the mouth at the bow."""
    items: Literal["bodies", "graph"] = "bodies"
    """`bodies`: wind and water move the items; `graph`: the rule of the graph world does."""
    item_classes: tuple[str, ...] = ("drifter",)
    """Classes of `models/debris.toml`, one drawn per item."""
    item_contacts: bool = False
    """Items that are bodies do not overlap; else they pass through each other."""
    intake_rate_per_s: Annotated[float, Above(0, 100, "1/s"), _MOUTH] | None = None
    """Items that a mouth takes in a second; absent: all that enter it at once."""
    intake_jam_items: Annotated[int, Within(0, 1000, "items"), _ARCH] = 0
    """With a rate: a mouth jams if it takes one of so many and more that lie in it; 0: never."""
    intake_jam_s: Annotated[float, Within(0, 3600, "s"), source("estimate: a decision")] = 10.0
    """Time for which a jammed mouth takes nothing."""
    integrator: Literal["fast", "reference"] = "fast"
    """`fast`: Euler with forces averaged over the step; `reference`: Runge-Kutta of order 4."""
    step_s: Annotated[float, Within(1e-3, 0.1, "s")] | None = None
    """Time step of the integrator, by default 0.1 s of `fast` and 0.02 s of `reference`."""
    device: Device = "cpu"
    """Engine of the hulls: MuJoCo, or MuJoCo Warp on this processor (slow) or on a GPU."""
    scale: Scale = Scale()
    spread: Spread = Spread()


@dataclass(frozen=True)
class CorruptionChoice:
    """A team whose actions are partly random (CSSC)."""

    team: str = ""
    """Name of the corrupted team; empty: none."""
    epsilon: Annotated[float, Within(0, 1)] = 0.0
    """Probability per decision that an action is random."""
    whole_team: bool = False
    """True: one draw decides for the whole team, as in the published code."""


@dataclass(frozen=True)
class Scenario:
    """A mission: everything that decides an episode, apart from seed, policy and world."""

    name: str
    """Name of the mission, and of its run folder."""
    map: MapChoice
    team: Mapping[str, Role]
    """Teams by name, in the order of the file, which numbers the agents."""
    description: str = ""
    """One line for lists and reports."""
    horizon: Annotated[int, Within(1, 30000, "decisions"), source("paper: T = 150")] = 150
    """Decisions in an episode."""
    period_s: Annotated[float, Within(1e-3, 1e6, "s")] = 10.0
    """Time of one decision."""
    rules: Rules = Rules()
    items: Items = Items()
    weather: Weather = Weather()
    physics: Physics = field(default_factory=Physics)
    sensors: Sensors = field(default_factory=Sensors)
    link: Link = field(default_factory=Link)
    corruption: CorruptionChoice = CorruptionChoice()
    faults: Faults = field(default_factory=Faults)
    prior: Prior = field(default_factory=Prior)
