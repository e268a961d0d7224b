"""Accelerations of vessels by Warp, from the same source as the CPU's."""

from typing import Any

import numpy as np
import pytest
import warp as wp

from mjforage.base.warped import struct_of, warped
from mjforage.physics.callback import vessel_motion
from mjforage.physics.hydrodynamics.parameters import VesselParameters, pack
from mjforage.physics.vessels import load_vessel
from mjforage.scenario.vessel_files import vessel_names

STATES, STEP_S = 10_000, 0.1
Parameters = struct_of(VesselParameters)
Surroundings = struct_of(vessel_motion.Surroundings)
inertia, mean_acceleration, damping = map(
    warped, (vessel_motion.inertia, vessel_motion.mean_acceleration, vessel_motion.damping)
)


@wp.kernel
def motions(
    p: Parameters,  # type: ignore[valid-type]
    x: wp.array2d(dtype=float),  # type: ignore[valid-type]
    out: wp.array2d(dtype=float),  # type: ignore[valid-type]
) -> None:
    i = wp.tid()
    about = Surroundings(x[i, 8], x[i, 9], x[i, 10], x[i, 11], x[i, 12], x[i, 13], x[i, 14])
    body = inertia(p, about.load)
    command, lagged = wp.vec2(x[i, 4], x[i, 5]), wp.vec2(x[i, 6], x[i, 7])
    ax, ay, ar = mean_acceleration(
        p, body, x[i, 0], x[i, 1], x[i, 2], x[i, 3], command, lagged, about, 0.1
    )
    du, dv, dr = damping(p, x[i, 0], x[i, 1], x[i, 2], x[i, 3], lagged, about)
    out[i, 0] = ax
    out[i, 1] = ay
    out[i, 2] = ar
    out[i, 3] = du
    out[i, 4] = dv
    out[i, 5] = dr


def drawn(low: float, high: float) -> Any:
    """States (state, 15): yaw, velocities, commands, lagged commands, surroundings."""
    random, x = np.random.default_rng(7), np.zeros((STATES, 15))
    x[:, 0] = random.uniform(-np.pi, np.pi, STATES)
    x[:, 1:4] = random.normal(size=(STATES, 3)) * (1.0, 1.0, 0.5)
    x[:, 4:8] = random.uniform(low, high, (STATES, 4))
    x[:, 8:12] = random.normal(size=(STATES, 4)) * (6.0, 6.0, 0.3, 0.3)
    x[:, 12] = random.integers(0, 50, STATES)
    x[:, 13:] = random.choice((1.0, 0.7, 0.0), (STATES, 2), p=(0.8, 0.1, 0.1))
    edges = x[: STATES // 10]
    edges[:, 1:4] *= random.integers(0, 2, (len(edges), 3))  # at rest, not turning, along an axis
    edges[:, 8:12] *= random.integers(0, 2, (len(edges), 4))
    return x.astype(np.float32)


@pytest.mark.parametrize("name", vessel_names())
def test_accelerations_are_those_of_the_cpu(name: str) -> None:
    """To 1e-5 of the vector's length at 10,000 states; so is the slope of drag and thrust."""
    vessel = load_vessel(name)
    record: Any = pack(vessel)
    given = Parameters()
    for field in record.dtype.names:
        setattr(given, field, float(record[field]))
    states = drawn(*vessel.thruster.command_range)
    out: Any = wp.zeros((STATES, 6), dtype=float, device="cpu")
    wp.launch(motions, STATES, [given, wp.array(states, dtype=float, device="cpu"), out])
    known = np.empty((STATES, 6))
    for i, x in enumerate(states.astype(np.float64).tolist()):
        yaw, vx, vy, r, *commands = x[:8]
        about = vessel_motion.Surroundings(*x[8:])
        body = vessel_motion.inertia(record, about.load)
        command, lagged = (commands[0], commands[1]), (commands[2], commands[3])
        known[i, :3] = vessel_motion.mean_acceleration(
            record, body, yaw, vx, vy, r, command, lagged, about, STEP_S
        )
        known[i, 3:] = vessel_motion.damping(record, yaw, vx, vy, r, lagged, about)
    found = out.numpy()
    for part in (slice(0, 3), slice(3, 6)):
        off = np.linalg.norm(found[:, part] - known[:, part], axis=1)
        assert (off <= 1e-5 * np.linalg.norm(known[:, part], axis=1) + 1e-12).all()
