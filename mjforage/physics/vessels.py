"""A vessel's parameters with units and ranges, and checks that a body can have them.

The schema of a vessel file, strict TOML. Everything refers to midships, in the body frame
x forward, y port, z up; coefficients are magnitudes, so the marine tables (x forward, y starboard,
z down) keep their numbers, and only the side of a lever changes sign: port is +y here.
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Discriminator

from mjforage.base.errors import UserError
from mjforage.base.toml_files import read_toml
from mjforage.controllers.propulsion import WATER_DENSITY_KGPM3
from mjforage.scenario.quantities import Quantity, positive
from mjforage.scenario.schema import NotInFile, check
from mjforage.scenario.vessel_files import vessel_path


@dataclass(frozen=True)
class CrossFlow:
    """Sideways drag per metre of length, 1/2 rho Cd T |v + x r| (v + x r)."""

    kind: Literal["integrated", "strips-otter"]
    """``integrated`` over the length; ``strips-otter``: 21 strips of length/20, their ends half a
    strip outside the vessel, as in the Otter's reference model (5 % too much sway drag)."""
    coefficient: Annotated[float, positive("1", 10)]
    """Two-dimensional drag coefficient Cd."""
    draft_m: Annotated[float, positive("m", 100)]
    """Draught T of the sections."""
    length_m: Annotated[float, positive("m", 1e3)]
    """Length over which the drag acts."""
    water_density_kgpm3: Annotated[float, positive("kg/m3", 2e3)]
    """Density rho of the water."""


@dataclass(frozen=True)
class Propeller:
    """T = k n |n| of the speed n, each way with its own k."""

    k_ahead: Annotated[float, positive("N s2/rad2", 1e6)]
    """Thrust over the squared speed of the propeller, ahead."""
    k_astern: Annotated[float, positive("N s2/rad2", 1e6)]
    """The same astern."""
    n_max_ahead: Annotated[float, positive("rad/s", 1e5)]
    """Highest speed of the propeller ahead."""
    n_max_astern: Annotated[float, positive("rad/s", 1e5)]
    """Highest speed of the propeller astern."""
    kind: Literal["propeller"] = "propeller"
    """A command is the speed of the propeller."""

    @property
    def command_unit(self) -> str:
        """Unit of a command."""
        return "rad/s"

    @property
    def command_range(self) -> tuple[float, float]:
        """Lowest and highest command [rad/s]."""
        return -self.n_max_astern, self.n_max_ahead

    @property
    def thrust_range(self) -> tuple[float, float]:
        """Lowest and highest steady thrust of one side [N]."""
        return -self.k_astern * self.n_max_astern**2, self.k_ahead * self.n_max_ahead**2


@dataclass(frozen=True)
class ForceThruster:
    """The command is the thrust [N], nothing inside the dead zone."""

    max_ahead_newton: Annotated[float, positive("N", 1e7)]
    """Highest thrust of one side ahead."""
    max_astern_newton: Annotated[float, positive("N", 1e7)]
    """Highest thrust of one side astern."""
    dead_zone_newton: Annotated[float, Quantity("N", 0.0, 1e7)]
    """Commands below this give no thrust."""
    kind: Literal["force"] = "force"
    """A command is the thrust."""

    @property
    def command_unit(self) -> str:
        """Unit of a command."""
        return "N"

    @property
    def command_range(self) -> tuple[float, float]:
        """Lowest and highest command [N]."""
        return -self.max_astern_newton, self.max_ahead_newton

    @property
    def thrust_range(self) -> tuple[float, float]:
        """Lowest and highest steady thrust of one side [N]."""
        return self.command_range


@dataclass(frozen=True)
class Windage:
    """Wind load after Blendermann (1994), coefficients on their own areas."""

    area_front_m2: Annotated[float, Quantity("m2", 0.0, 1e5)]
    """Area seen from ahead."""
    area_side_m2: Annotated[float, Quantity("m2", 0.0, 1e5)]
    """Area seen from the side."""
    cdt: Annotated[float, positive("1", 10)]
    """Transverse resistance CD_t."""
    cdl_bow: Annotated[float, Quantity("1", 0.0, 10)]
    """Longitudinal resistance CD_l, wind from ahead."""
    cdl_stern: Annotated[float, Quantity("1", 0.0, 10)]
    """Longitudinal resistance CD_l, wind from astern."""
    delta: Annotated[float, Quantity("1", 0.0, 1.0)]
    """Cross-force parameter."""
    s_l_m: Annotated[float, Quantity("m", -1e3, 1e3)]
    """Centroid of the side area, forward of midships."""

    @property
    def any(self) -> bool:
        """True if there is an area that the wind meets."""
        return self.area_front_m2 > 0.0 or self.area_side_m2 > 0.0


@dataclass(frozen=True)
class Load:
    """Mass and drag that every collected item adds; its weight is carried at midships."""

    mass_per_item_kg: Annotated[float, Quantity("kg", 0.0, 1e4)]
    """Mass of an item on board."""
    drag_per_item: Annotated[float, Quantity("N s2/m2", 0.0, 1e4)]
    """Quadratic drag in surge that an item adds."""


@dataclass(frozen=True)
class Power:
    """Propellers, whose thrust falls with speed, and the power drawn from the battery."""

    propeller_m: Annotated[float, positive("m", 10)]
    """Diameter of each propeller, or of each water jet."""
    motor_w: Annotated[float, positive("W", 1e7)]
    """Electrical power of each motor at the most thrust, and the most it ever draws."""
    hotel_w: Annotated[float, Quantity("W", 0.0, 1e6)]
    """Constant power of computers, sensors and radio."""

    @property
    def disc_kgpm(self) -> float:
        """2 rho A of a propeller in sea water [kg/m]."""
        return 2.0 * WATER_DENSITY_KGPM3 * math.pi / 4.0 * self.propeller_m**2


@dataclass(frozen=True)
class Control:
    """Tuning of the vessel's controllers (see `controllers`)."""

    cruise_ahead_mps: Annotated[float, positive("m/s", 100)]
    """Speed over ground on a long leg ahead."""
    cruise_astern_mps: Annotated[float, positive("m/s", 100)]
    """Speed over ground on a long leg astern."""
    acceleration_mps2: Annotated[float, positive("m/s2", 100)]
    """Acceleration of the speed's reference."""
    brake_mps2: Annotated[float, positive("m/s2", 100)]
    """Deceleration that is always at hand; stopping distances count on it."""
    yaw_rate_radps: Annotated[float, positive("rad/s", 10)]
    """Highest turning rate of the heading's reference."""
    yaw_acceleration_radps2: Annotated[float, positive("rad/s2", 100)]
    """Angular acceleration of the heading's reference."""
    heading_bandwidth_radps: Annotated[float, positive("rad/s", 10)]
    """Bandwidth of the heading controller."""
    heading_damping: Annotated[float, positive("1", 10)]
    """Damping ratio of the heading controller."""
    heading_integral_s: Annotated[float, positive("s", 1e4)]
    """Integral time of the heading controller."""
    speed_bandwidth_radps: Annotated[float, positive("rad/s", 10)]
    """Bandwidth of the speed controller."""
    speed_integral_s: Annotated[float, positive("s", 1e4)]
    """Integral time of the speed controller."""
    lookahead_m: Annotated[float, positive("m", 1e4)]
    """Lookahead distance of the line-of-sight guidance."""
    drift_gain_mps: Annotated[float, positive("m/s", 100)]
    """Gain kappa of the guidance's integral against drift."""
    hold_bandwidth_radps: Annotated[float, positive("rad/s", 10)]
    """Bandwidth of keeping position."""
    hold_integral_s: Annotated[float, positive("s", 1e4)]
    """Integral time of keeping position."""
    hold_radius_m: Annotated[float, positive("m", 1e3)]
    """Distance from the place to keep beyond which a vessel turns towards it."""
    clearance_m: Annotated[float, Quantity("m", 0.0, 1e3)]
    """Distance to keep to other vessels and quays."""
    filter_s: Annotated[float, Quantity("s", 0.0, 1e3)]
    """Time constant of the filters on measured position and heading."""


NO_WINDAGE = Windage(0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)
NO_LOAD = Load(0.0, 0.0)


@dataclass(frozen=True, repr=False)
class Vessel:
    """One parameter set.

    Absent tables: no cross-flow drag, no wind load, no load, a thrust that does not fall with speed
    and no power drawn, and a tuning that `physics.vessel_models` works out.

    Examples
    --------
    >>> import dataclasses, mjforage as mf
    >>> heavy = dataclasses.replace(mf.load_vessel("otter"), name="heavy", mass_kg=90.0)
    >>> port = mf.load_scenario("comb-port", physics={"vessels": {"foragers": heavy}})
    """

    name: Annotated[str, NotInFile()]
    description: str
    """Kind of vessel, in one line."""
    length_m: Annotated[float, positive("m", 1e3)]
    """Length of the vessel."""
    beam_m: Annotated[float, positive("m", 1e3)]
    """Width of the vessel."""
    draft_m: Annotated[float, positive("m", 100)]
    """Draught of the vessel."""
    mass_kg: Annotated[float, positive("kg", 1e8)]
    """Mass of the rigid body, payload included."""
    cog_x_m: Annotated[float, Quantity("m", -1e3, 1e3)]
    """Centre of gravity, forward of midships."""
    inertia_z_kgm2: Annotated[float, positive("kg m2", 1e12)]
    """Yaw inertia of the rigid body about midships."""
    added_mass_surge_kg: Annotated[float, Quantity("kg", 0.0, 1e8)]
    """Added mass ahead."""
    added_mass_sway_kg: Annotated[float, Quantity("kg", 0.0, 1e8)]
    """Added mass sideways."""
    added_mass_yaw_kgm2: Annotated[float, Quantity("kg m2", 0.0, 1e12)]
    """Added inertia in yaw."""
    linear_surge: Annotated[float, Quantity("N s/m", 0.0, 1e9)]
    """Linear damping in surge."""
    linear_sway: Annotated[float, Quantity("N s/m", 0.0, 1e9)]
    """Linear damping in sway."""
    linear_yaw: Annotated[float, Quantity("N m s", 0.0, 1e12)]
    """Linear damping in yaw."""
    quadratic_surge: Annotated[float, Quantity("N s2/m2", 0.0, 1e9)]
    """Quadratic damping in surge."""
    quadratic_sway: Annotated[float, Quantity("N s2/m2", 0.0, 1e9)]
    """Quadratic damping in sway."""
    quadratic_yaw: Annotated[float, Quantity("N m s2", 0.0, 1e12)]
    """Quadratic damping in yaw."""
    yaw_linear_growth: Annotated[float, Quantity("s", 0.0, 1e4)]
    """g in N = -linear_yaw (1 + g |r|) r."""
    lever_m: Annotated[float, positive("m", 1e3)]
    """Distance of each thruster from the centre line: port at +y, starboard at -y."""
    lag_s: Annotated[float, positive("s", 1e3)]
    """Time constant of each thruster."""
    thruster: Annotated[Propeller | ForceThruster, Discriminator("kind")]
    """Two thrusters side by side, steered by their difference."""
    crossflow: CrossFlow | None = None
    windage: Windage = NO_WINDAGE
    load: Load = NO_LOAD
    power: Power | None = None
    control: Control | None = None

    def __repr__(self) -> str:
        size = f"{self.length_m:g} x {self.beam_m:g} m, {self.mass_kg:g} kg"
        return f"Vessel({self.name}, {size})"


def load_vessel(name_or_path: str | Path) -> Vessel:
    """Read a shipped vessel by name, or anyone's by path of a TOML file.

    Raises
    ------
    UserError
        If there is no such vessel, if the file is not a valid one, or if no body can have its
        parameters.

    Examples
    --------
    >>> import mjforage as mf
    >>> mf.load_vessel("otter").length_m
    2.0
    """
    path = vessel_path(name_or_path)
    where = f"vessel {path.stem}"
    vessel = check(Vessel, read_toml(path, where), where, name=path.stem)
    check_vessel(vessel, where)
    return vessel


def check_vessel(vessel: Vessel, where: str) -> None:
    """Check inertia, damping and thrust together, which no single range can.

    Raises
    ------
    UserError
        If no body can have these parameters.
    """
    least = vessel.mass_kg * vessel.cog_x_m**2
    if vessel.inertia_z_kgm2 <= least:
        raise UserError(
            f"{where}: inertia_z_kgm2 = {vessel.inertia_z_kgm2:g} is indefinite inertia: a mass of "
            f"{vessel.mass_kg:g} kg at {vessel.cog_x_m:g} m needs more than {least:.6g} kg m2 "
            "about midships; raise inertia_z_kgm2 or bring cog_x_m nearer to 0"
        )
    if abs(vessel.cog_x_m) >= 0.5 * vessel.length_m:
        raise UserError(
            f"{where}: cog_x_m = {vessel.cog_x_m:g} is outside the vessel of "
            f"{vessel.length_m:g} m; give metres forward of midships"
        )
    side = vessel.crossflow is not None
    for axis, crossed in (("surge", False), ("sway", side), ("yaw", side)):
        damping = getattr(vessel, f"linear_{axis}") + getattr(vessel, f"quadratic_{axis}")
        if not damping and not crossed:
            raise UserError(
                f"{where}: no damping in {axis}; give linear_{axis} or quadratic_{axis} above 0"
            )
    if isinstance(vessel.thruster, ForceThruster):
        weakest = min(vessel.thruster.max_ahead_newton, vessel.thruster.max_astern_newton)
        if vessel.thruster.dead_zone_newton >= weakest:
            raise UserError(
                f"{where}: thruster.dead_zone_newton = {vessel.thruster.dead_zone_newton:g} leaves "
                f"no thrust; give less than {weakest:g}"
            )
    most = max(map(abs, vessel.thruster.thrust_range))
    if vessel.power and math.isfinite(most):
        least = math.sqrt(most**3 / vessel.power.disc_kgpm)
        if vessel.power.motor_w < least:
            raise UserError(
                f"{where}: power.motor_w = {vessel.power.motor_w:g} is less than the {least:.4g} W "
                f"that {most:.4g} N of thrust take at least with a propeller of "
                f"{vessel.power.propeller_m:g} m; raise motor_w or propeller_m"
            )
    if not all(math.isfinite(value) for value in vessel.thruster.thrust_range):
        raise UserError(f"{where}: thruster gives a thrust that is not finite; lower k or n_max")
