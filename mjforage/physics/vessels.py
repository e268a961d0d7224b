"""What a vessel is: its parameters with units and ranges, and whether a body can have them.

`vessel_file` reads them from strict TOML. Everything refers to midships, in the body frame
x forward, y port, z up; coefficients are magnitudes, so the marine tables (x forward, y starboard,
z down) keep their numbers, and only the side of a lever changes sign: port is +y here.
"""

import dataclasses
import math
from dataclasses import dataclass, field
from pathlib import Path

from mjforage.core.errors import UserError
from mjforage.physics.vessel_file import positive, quantity, read_vessel, vessel_names

__all__ = [
    "Control",
    "CrossFlow",
    "ForceThruster",
    "Load",
    "Propeller",
    "Vessel",
    "Windage",
    "load_vessel",
    "vessel_names",
    "with_load",
]


@dataclass(frozen=True)
class CrossFlow:
    """`[crossflow]`: sideways drag per metre of length, 1/2 rho Cd T |v + x r| (v + x r)."""

    kind: str = field(metadata={"choices": ("integrated", "strips-otter")})
    """``integrated`` over the length; ``strips-otter``: 21 strips of length/20, their ends half a
    strip outside the hull, as in the Otter's reference model (5 % too much sway drag)."""
    coefficient: float = field(metadata=positive("1", 10))  # two-dimensional drag coefficient
    draft_m: float = field(metadata=positive("m", 100))
    length_m: float = field(metadata=positive("m", 1e3))
    water_density_kgpm3: float = field(metadata=positive("kg/m3", 2e3))


@dataclass(frozen=True)
class Propeller:
    """`[thruster]`, kind ``propeller``: T = k n |n| of the speed n, each way with its own k."""

    k_ahead: float = field(metadata=positive("N s2/rad2", 1e6))
    k_astern: float = field(metadata=positive("N s2/rad2", 1e6))
    n_max_ahead: float = field(metadata=positive("rad/s", 1e5))
    n_max_astern: float = field(metadata=positive("rad/s", 1e5))

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
    """`[thruster]`, kind ``force``: the command is the thrust [N], nothing inside the dead zone."""

    max_ahead_newton: float = field(metadata=positive("N", 1e7))
    max_astern_newton: float = field(metadata=positive("N", 1e7))
    dead_zone_newton: float = field(metadata=quantity("N", 0.0, 1e7))

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
    """`[windage]`: wind load after Blendermann (1994), coefficients on their own areas."""

    area_front_m2: float = field(metadata=quantity("m2", 0.0, 1e5))
    area_side_m2: float = field(metadata=quantity("m2", 0.0, 1e5))
    cdt: float = field(metadata=positive("1", 10))  # transverse resistance CD_t
    cdl_bow: float = field(metadata=quantity("1", 0.0, 10))  # longitudinal CD_l, wind from ahead
    cdl_stern: float = field(metadata=quantity("1", 0.0, 10))  # the same, wind from astern
    delta: float = field(metadata=quantity("1", 0.0, 1.0))  # cross-force parameter
    s_l_m: float = field(metadata=quantity("m", -1e3, 1e3))
    """Centroid of the side area, forward of midships."""


@dataclass(frozen=True)
class Load:
    """`[load]`: what every collected item adds; its weight is carried at midships."""

    mass_per_item_kg: float = field(metadata=quantity("kg", 0.0, 1e4))
    drag_per_item: float = field(metadata=quantity("N s2/m2", 0.0, 1e4))  # quadratic, in surge


@dataclass(frozen=True)
class Control:
    """`[control]`: tuning of the hull's controllers (see `controllers`)."""

    cruise_ahead_mps: float = field(metadata=positive("m/s", 100))  # over ground, on a long leg
    cruise_astern_mps: float = field(metadata=positive("m/s", 100))
    acceleration_mps2: float = field(metadata=positive("m/s2", 100))  # of the speed's reference
    brake_mps2: float = field(metadata=positive("m/s2", 100))
    """Deceleration that is always at hand; stopping distances count on it."""
    yaw_rate_radps: float = field(metadata=positive("rad/s", 10))  # of the heading's reference
    yaw_acceleration_radps2: float = field(metadata=positive("rad/s2", 100))
    heading_bandwidth_radps: float = field(metadata=positive("rad/s", 10))
    heading_damping: float = field(metadata=positive("1", 10))
    heading_integral_s: float = field(metadata=positive("s", 1e4))
    speed_bandwidth_radps: float = field(metadata=positive("rad/s", 10))
    speed_integral_s: float = field(metadata=positive("s", 1e4))
    lookahead_m: float = field(metadata=positive("m", 1e4))  # of the line-of-sight guidance
    drift_gain_mps: float = field(metadata=positive("m/s", 100))  # kappa of its integral
    hold_bandwidth_radps: float = field(metadata=positive("rad/s", 10))  # of keeping position
    hold_integral_s: float = field(metadata=positive("s", 1e4))
    hold_radius_m: float = field(metadata=positive("m", 1e3))
    """How far beside its place a hull may lie before it turns."""
    clearance_m: float = field(metadata=quantity("m", 0.0, 1e3))  # to other hulls and quays
    filter_s: float = field(metadata=quantity("s", 0.0, 1e3))
    """Time constant of the filters on measured position and heading."""


NO_WINDAGE = Windage(0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)
NO_LOAD = Load(0.0, 0.0)


@dataclass(frozen=True)
class Vessel:
    """One parameter set.

    Absent tables: no cross-flow drag, no wind load, no load, and a tuning that `physics.helm` works
    out.
    """

    name: str
    description: str
    length_m: float = field(metadata=positive("m", 1e3))
    beam_m: float = field(metadata=positive("m", 1e3))
    draft_m: float = field(metadata=positive("m", 100))
    mass_kg: float = field(metadata=positive("kg", 1e8))  # rigid body, payload included
    cog_x_m: float = field(metadata=quantity("m", -1e3, 1e3))  # forward of midships
    inertia_z_kgm2: float = field(metadata=positive("kg m2", 1e12))  # rigid body, about midships
    added_mass_surge_kg: float = field(metadata=quantity("kg", 0.0, 1e8))
    added_mass_sway_kg: float = field(metadata=quantity("kg", 0.0, 1e8))
    added_mass_yaw_kgm2: float = field(metadata=quantity("kg m2", 0.0, 1e12))
    linear_surge: float = field(metadata=quantity("N s/m", 0.0, 1e9))
    linear_sway: float = field(metadata=quantity("N s/m", 0.0, 1e9))
    linear_yaw: float = field(metadata=quantity("N m s", 0.0, 1e12))
    quadratic_surge: float = field(metadata=quantity("N s2/m2", 0.0, 1e9))
    quadratic_sway: float = field(metadata=quantity("N s2/m2", 0.0, 1e9))
    quadratic_yaw: float = field(metadata=quantity("N m s2", 0.0, 1e12))
    yaw_linear_growth: float = field(metadata=quantity("s", 0.0, 1e4))
    """g in N = -linear_yaw (1 + g |r|) r."""
    lever_m: float = field(metadata=positive("m", 1e3))  # port thruster at +y, starboard at -y
    lag_s: float = field(metadata=positive("s", 1e3))  # time constant of each thruster
    thruster: Propeller | ForceThruster
    crossflow: CrossFlow | None = None
    windage: Windage = NO_WINDAGE
    load: Load = NO_LOAD
    control: Control | None = None


def load_vessel(name_or_path: str | Path) -> Vessel:
    """Read a shipped vessel by name, or anyone's by path of a TOML file.

    Raises
    ------
    UserError
        If there is no such vessel, if the file is not a valid one, or if no body can have its
        parameters.
    """
    name, values = read_vessel(name_or_path, Vessel)
    vessel = Vessel(name=name, **values)
    _check(vessel, f"vessel {name}")
    return vessel


def with_load(vessel: Vessel, items: float) -> Vessel:
    """The vessel with that many items on board: heavier at midships, more drag in surge."""
    mass = vessel.mass_kg + items * vessel.load.mass_per_item_kg
    return dataclasses.replace(
        vessel,
        mass_kg=mass,
        cog_x_m=vessel.cog_x_m * vessel.mass_kg / mass,
        quadratic_surge=vessel.quadratic_surge + items * vessel.load.drag_per_item,
    )


def _check(vessel: Vessel, where: str) -> None:
    """What no single range can say: inertia, damping and thrust belong together."""
    least = vessel.mass_kg * vessel.cog_x_m**2
    if vessel.inertia_z_kgm2 <= least:
        raise UserError(
            f"{where}: inertia_z_kgm2 = {vessel.inertia_z_kgm2:g} is indefinite inertia: a mass of "
            f"{vessel.mass_kg:g} kg at {vessel.cog_x_m:g} m needs more than {least:.6g} kg m2 "
            "about midships; raise inertia_z_kgm2 or bring cog_x_m nearer to 0"
        )
    if abs(vessel.cog_x_m) >= 0.5 * vessel.length_m:
        raise UserError(
            f"{where}: cog_x_m = {vessel.cog_x_m:g} is outside the hull of {vessel.length_m:g} m; "
            "give metres forward of midships"
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
    if not all(math.isfinite(value) for value in vessel.thruster.thrust_range):
        raise UserError(f"{where}: thruster gives a thrust that is not finite; lower k or n_max")
