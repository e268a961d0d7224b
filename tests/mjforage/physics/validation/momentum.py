"""Any vessel a second time, in the plane: the momentum of hull and water, in marine axes.

From the numbers of the vessel's file alone (x forward, y to starboard, yaw clockwise). Kirchhoff's
equations move momentum and not velocity (Lamb 1932, section 124; Fossen 2021, section 6.3), so that
no Coriolis matrix and no Munk moment is written down; wind load goes by the angle that the wind
comes from (Blendermann 1994), cross-flow drag by quadrature. It shares no term, sign or frame with
`physics.hydrodynamics`. It is an oracle: slow.
"""

import math
from typing import TypeAlias

from mjforage.physics.hydrodynamics.conditions import Conditions, State
from mjforage.physics.vessels import Propeller, Vessel

Numbers: TypeAlias = list[float]

AIR_DENSITY = 1.224  # [kg/m3], Blendermann's tables
LONGEST_S = 0.0125  # steps of the classical Runge-Kutta method, a quarter of the shortest lag
_GAUSS = ((-math.sqrt(0.6), 5.0 / 9.0), (0.0, 8.0 / 9.0), (math.sqrt(0.6), 5.0 / 9.0))


def wind_load(vessel: Vessel, ahead: float, starboard: float) -> tuple[float, float, float]:
    """Wind load (X forward, Y to starboard [N], N clockwise [N m]) of air that moves past the hull.

    Parameters
    ----------
    ahead, starboard : velocity of the air relative to the hull [m/s]
    """
    wind = vessel.windage
    angle = math.atan2(abs(starboard), -ahead)  # between bow and where the wind comes from
    cdl = wind.cdl_bow if angle <= 0.5 * math.pi else wind.cdl_stern
    pressure = 0.5 * AIR_DENSITY * (ahead * ahead + starboard * starboard)
    bent = 1.0 - 0.5 * wind.delta * (1.0 - cdl / wind.cdt) * math.sin(2.0 * angle) ** 2
    x = -pressure * wind.area_front_m2 * cdl * math.cos(angle) / bent
    y = pressure * wind.area_side_m2 * wind.cdt * math.sin(angle) / bent
    y = math.copysign(y, starboard)
    return x, y, (wind.s_l_m - 0.18 * (angle - 0.5 * math.pi) * vessel.length_m) * y


def thrust(vessel: Vessel, command: float, speed: float) -> float:
    """Newtons of one side at a lagged command [rad/s or N] and its speed ahead [m/s].

    Moored the water gets the power T0 sqrt(T0 / (2 rho A)), and as much at any speed.
    """
    moored = _moored(vessel, command)
    inflow = math.copysign(1.0, moored) * speed
    if vessel.power is None or inflow <= 0.0 or moored == 0.0:
        return moored
    disc = 2.0 * 1025.0 * math.pi / 4.0 * vessel.power.propeller_m**2
    size = abs(moored)
    power = size * math.sqrt(size / disc)
    for _ in range(40):  # Newton's method on T (u + sqrt(u^2 + 4 T / (2 rho A))) / 2, from above
        wash = math.sqrt(inflow * inflow + 4.0 * size / disc)
        rest = 0.5 * size * (inflow + wash) - power
        step = rest / (0.5 * (inflow + wash) + size / (disc * wash))
        size -= step
        if abs(step) < 1e-14 * size:
            break
    return math.copysign(size, moored)


def _moored(vessel: Vessel, command: float) -> float:
    thruster = vessel.thruster
    low, high = thruster.command_range
    c = min(max(command, low), high)
    if isinstance(thruster, Propeller):
        return (thruster.k_ahead if c > 0.0 else thruster.k_astern) * math.copysign(c * c, c)
    return 0.0 if abs(c) < thruster.dead_zone_newton else c


def _cross_flow(vessel: Vessel, v: float, r: float) -> tuple[float, float]:
    """Sway force and yaw moment of cross-flow drag at v + x r, by strips or by quadrature."""
    flow = vessel.crossflow
    if flow is None:
        return 0.0, 0.0
    length, factor = flow.length_m, 0.5 * flow.water_density_kgpm3 * flow.coefficient * flow.draft_m
    if flow.kind == "strips-otter":
        places = [(length * (k / 20.0 - 0.5), length / 20.0) for k in range(21)]
    else:  # Gauss's rule is exact on either side of the place where the flow turns
        turn = min(max(-v / r, -0.5 * length), 0.5 * length) if r else 0.0
        spans = ((-0.5 * length, turn), (turn, 0.5 * length))
        places = [
            (0.5 * (a + b) + 0.5 * (b - a) * at, 0.5 * (b - a) * weight)
            for a, b in spans
            for at, weight in _GAUSS
        ]
    force = moment = 0.0
    for x, width in places:
        drag = -factor * width * abs(v + x * r) * (v + x * r)
        force, moment = force + drag, moment + x * drag
    return force, moment


class MomentumVessel:
    """A `SimulatedVessel` of any vessel; our east is its north, our north its west.

    Parameters
    ----------
    load : items aboard, at midships
    """

    def __init__(self, vessel: Vessel, conditions: Conditions, load: float = 0.0) -> None:
        self._vessel = vessel
        carried = load * vessel.load.mass_per_item_kg
        self._drag_of_load = load * vessel.load.drag_per_item
        self._m11 = vessel.mass_kg + carried + vessel.added_mass_surge_kg
        self._m22 = vessel.mass_kg + carried + vessel.added_mass_sway_kg
        self._m26 = vessel.mass_kg * vessel.cog_x_m
        self._m66 = vessel.inertia_z_kgm2 + vessel.added_mass_yaw_kgm2
        self._water = complex(conditions.current_mps[0], -conditions.current_mps[1])
        self._air = complex(conditions.wind_mps[0], -conditions.wind_mps[1]) - self._water
        x, y, yaw, u, v, r = conditions.start
        past = complex(u, -v) - self._water * complex(math.cos(yaw), math.sin(yaw))
        u, v, r = past.real, past.imag, -r
        momenta = (self._m11 * u, self._m22 * v + self._m26 * r, self._m66 * r + self._m26 * v)
        self._state = [x, -y, -yaw, *momenta, 0.0, 0.0]

    def _motion(self, p1: float, p2: float, h: float) -> tuple[float, float, float]:
        """Velocity through the water, ahead and to starboard, and yaw rate, of momenta."""
        whole = self._m22 * self._m66 - self._m26 * self._m26
        sway = (self._m66 * p2 - self._m26 * h) / whole
        return p1 / self._m11, sway, (self._m22 * h - self._m26 * p2) / whole

    def _loads(
        self, u: float, v: float, r: float, left: float, right: float
    ) -> tuple[float, float, float]:
        """Forces and moment of drag and thrust."""
        b = self._vessel
        side, turn = _cross_flow(b, v, r)
        ahead = (b.quadratic_surge + self._drag_of_load) * abs(u) + b.linear_surge
        swing = b.linear_yaw * (1.0 + b.yaw_linear_growth * abs(r)) + b.quadratic_yaw * abs(r)
        return (
            left + right - ahead * u,
            side - (b.linear_sway + b.quadratic_sway * abs(v)) * v,
            turn - swing * r + b.lever_m * (left - right),  # port pushes the bow to starboard
        )

    def _slope(self, state: Numbers, port: float, starboard: float) -> Numbers:
        _, _, yaw, p1, p2, h, left, right = state
        u, v, r = self._motion(p1, p2, h)
        bow = complex(math.cos(yaw), math.sin(yaw))
        place = bow * complex(u, v) + self._water
        past = self._air * bow.conjugate() - complex(u, v)
        beside = self._vessel.lever_m * r  # r is clockwise: port goes faster
        pushes = thrust(self._vessel, left, u + beside), thrust(self._vessel, right, u - beside)
        x, y, n = self._loads(u, v, r, *pushes)
        x_wind, y_wind, n_wind = wind_load(self._vessel, past.real, past.imag)
        return [
            place.real,
            place.imag,
            r,
            x + x_wind + r * p2,
            y + y_wind - r * p1,
            n + n_wind + v * p1 - u * p2,
            (port - left) / self._vessel.lag_s,
            (starboard - right) / self._vessel.lag_s,
        ]

    def step(self, port: float, starboard: float, step_s: float) -> None:
        """Advance under constant commands [rad/s or N]."""
        low, high = self._vessel.thruster.command_range
        port, starboard = min(max(port, low), high), min(max(starboard, low), high)
        parts = math.ceil(step_s / LONGEST_S - 1e-9)
        h, s = step_s / parts, self._state
        for _ in range(parts):
            k1 = self._slope(s, port, starboard)
            k2 = self._slope(_ahead(s, 0.5 * h, k1), port, starboard)
            k3 = self._slope(_ahead(s, 0.5 * h, k2), port, starboard)
            k4 = self._slope(_ahead(s, h, k3), port, starboard)
            mean = [
                (a + 2.0 * (b + c) + d) / 6.0 for a, b, c, d in zip(k1, k2, k3, k4, strict=True)
            ]
            s = _ahead(s, h, mean)
        self._state = s

    def state(self) -> State:
        """Our row: x east, y north, yaw counter-clockwise, over ground, y to port."""
        north, east, yaw, p1, p2, h, _, _ = self._state
        u, v, r = self._motion(p1, p2, h)
        ground = complex(u, v) + self._water * complex(math.cos(yaw), -math.sin(yaw))
        return north, -east, -yaw, ground.real, -ground.imag, -r


def _ahead(state: Numbers, step_s: float, slope: Numbers) -> Numbers:
    return [value + step_s * rate for value, rate in zip(state, slope, strict=True)]
