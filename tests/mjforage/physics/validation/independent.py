"""The Otter a second time, with nothing of our model: six degrees of freedom in marine axes.

Written from the numbers of the published parameter set, with the surge damping of our file (its
thrust falls with speed), in their own frame (x forward,
y to starboard, z down; yaw clockwise), with Coriolis matrices made from the inertia matrices
(Fossen 2021, theorem 3.2) and body-axes accelerations. Frame, signs, terms and integrator are thus
others than in `physics.hydrodynamics`, and roll, pitch and heave move. It is an oracle: slow, and
for the plain Otter only.
"""

import math

import numpy as np
from numpy.typing import NDArray

from mjforage.physics.hydrodynamics.conditions import Conditions, State
from mjforage.physics.vessels import Vessel

Array = NDArray[np.float64]

MASS_KG, COG_X_M, COG_Z_M = 80.0, 0.153, -0.247
LEVER_M, LAG_S = 0.395, 0.1
K_AHEAD, K_ASTERN, N_MAX, N_MIN = 0.01108, 0.006445, 103.94, -101.74
ADDED = np.diag([5.28, 82.5, 55.0, 2.13, 11.62, 24.03])
DISC_KGPM = 2.0 * 1025.0 * math.pi / 4.0 * 0.2**2  # 2 rho A
DAMPING = np.array([31.9, 162.5, 605.4, 52.28, 226.7, 40.05])
YAW_GROWTH_S = 10.0
RESTORING = np.array([0.0, 0.0, 7541.0, 967.0, 2743.0, 0.0])
STRIP_X_M = np.linspace(-1.0, 1.0, 21)
STRIP_FACTOR = 0.5 * 1025.0 * 1.0 * 0.195 * 0.1  # 1/2 rho Cd T dx
LONGEST_S = 0.05  # steps of the classical Runge-Kutta method


def cross(a: Array) -> Array:
    """S(a), with S(a) b = a x b."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def _rigid_body() -> Array:
    """M_RB about midships, centre of gravity ahead of and above it."""
    inertia = np.diag([15.53, 21.28, 16.01])
    inertia[0, 2] = inertia[2, 0] = -MASS_KG * COG_X_M * COG_Z_M
    offset = MASS_KG * cross(np.array([COG_X_M, 0.0, COG_Z_M]))
    return np.block([[MASS_KG * np.eye(3), -offset], [offset, inertia]])


_TOTAL = _rigid_body() + ADDED
_INVERSE = np.linalg.inv(_TOTAL)


def thrust(n: float, speed: float) -> float:
    """Newtons of one side at n [rad/s] and a speed ahead of the propeller [m/s].

    The speed v through the disc is the root of v^3 - u v^2 = w^3, with the w of a moored propeller.
    """
    n = min(max(n, N_MIN), N_MAX)
    moored = (K_AHEAD if n > 0.0 else K_ASTERN) * n * abs(n)
    still, inflow = math.sqrt(abs(moored) / DISC_KGPM), speed if n > 0.0 else -speed
    if still == 0.0 or inflow <= 0.0:
        return moored
    roots = np.roots([1.0, -inflow, 0.0, -(still**3)])
    return moored * still / float(roots[np.abs(roots.imag) < 1e-9].real.max())


def _acceleration(nu: Array, pose: Array, n: Array) -> Array:
    """d(nu)/dt of the velocity relative to the water, propellers at n, port first."""
    left = thrust(float(n[0]), float(nu[0] + LEVER_M * nu[5]))
    right = thrust(float(n[1]), float(nu[0] - LEVER_M * nu[5]))
    momentum, spin = _TOTAL[:3] @ nu, _TOTAL[3:] @ nu
    turning = np.concatenate(
        (-np.cross(momentum, nu[3:]), -np.cross(momentum, nu[:3]) - np.cross(spin, nu[3:]))
    )  # C(nu) nu of M_RB + M_A together
    damping = DAMPING * nu
    damping[5] *= 1.0 + YAW_GROWTH_S * abs(nu[5])
    flow = nu[1] + STRIP_X_M * nu[5]
    drag = -STRIP_FACTOR * np.abs(flow) * flow
    load = -turning - damping - RESTORING * pose
    load[0] += left + right
    load[1] += drag.sum()
    load[5] += LEVER_M * (left - right) + STRIP_X_M @ drag  # port pushes the bow to starboard
    return np.asarray(_INVERSE @ load)


def _rotation(roll: float, pitch: float, yaw: float) -> Array:
    cr, cp, cy = math.cos(roll), math.cos(pitch), math.cos(yaw)
    sr, sp, sy = math.sin(roll), math.sin(pitch), math.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, sy * sr + cy * cr * sp],
            [sy * cp, cy * cr + sr * sp * sy, sp * sy * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


class IndependentOtter:
    """The plain Otter as a `SimulatedVessel`; our east is its north, our north its west."""

    def __init__(self, vessel: Vessel, conditions: Conditions) -> None:
        del vessel  # the numbers are its own
        east, north = conditions.current_mps
        x, y, yaw, u, v, r = conditions.start
        self._water = np.array([east, -north, 0.0])
        self._pose = np.array([x, -y, 0.0, 0.0, 0.0, -yaw])
        self._nu = np.array([u, -v, 0.0, 0.0, 0.0, -r])
        self._nu[:3] -= _rotation(0.0, 0.0, -yaw).T @ self._water
        self._n = np.zeros(2)

    def step(self, port: float, starboard: float, step_s: float) -> None:
        """Advance under constant commands [rad/s]."""
        parts = math.ceil(step_s / LONGEST_S - 1e-9)
        command = np.array([port, starboard])
        for _ in range(parts):
            self._advance(command, step_s / parts)

    def _advance(self, command: Array, h: float) -> None:
        state = np.concatenate((self._pose, self._nu, self._n))
        k1 = self._slope(state, command)
        k2 = self._slope(state + 0.5 * h * k1, command)
        k3 = self._slope(state + 0.5 * h * k2, command)
        k4 = self._slope(state + h * k3, command)
        state = state + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
        self._pose, self._nu, self._n = state[:6], state[6:12], state[12:]

    def _slope(self, state: Array, command: Array) -> Array:
        pose, nu, n = state[:6], state[6:12], state[12:]
        roll, pitch = float(pose[3]), float(pose[4])
        place = _rotation(roll, pitch, float(pose[5])) @ nu[:3] + self._water
        p, q, r = nu[3:]
        about = math.sin(roll) * q + math.cos(roll) * r
        rates = [
            p + math.tan(pitch) * about,
            math.cos(roll) * q - math.sin(roll) * r,
            about / math.cos(pitch),
        ]
        gained = _acceleration(nu, pose, n)
        return np.concatenate((place, rates, gained, (command - n) / LAG_S))

    def state(self) -> State:
        """Our row: x east, y north, yaw counter-clockwise, over ground, y to port."""
        x, y, _, roll, pitch, yaw = (float(value) for value in self._pose)
        over_ground = self._nu[:3] + _rotation(roll, pitch, yaw).T @ self._water
        u, v = float(over_ground[0]), float(over_ground[1])
        return x, -y, -yaw, u, -v, -float(self._nu[5])
