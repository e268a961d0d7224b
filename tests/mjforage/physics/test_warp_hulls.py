"""Vessels in Warp against the CPU's: accelerations, and manoeuvres in MuJoCo."""

from typing import Any

import numpy as np
import pytest
import warp as wp

from mjforage.base.errors import UserError
from mjforage.base.warped import warped
from mjforage.physics.callback import vessel_motion
from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.scene import Scene, build_scene
from mjforage.physics.simulation import Simulation
from mjforage.physics.vessels import load_vessel
from mjforage.physics.warp_hulls import Parameters, Surroundings, WarpHulls, _given
from mjforage.scenario.vessel_files import vessel_names

STATES, STEP_S = 10_000, 0.1
inertia, mean_acceleration, damping = map(
    warped, (vessel_motion.inertia, vessel_motion.mean_acceleration, vessel_motion.damping)
)


@wp.kernel
def motions(
    p: Parameters,
    x: wp.array2d(dtype=float),  # type: ignore[valid-type]
    out: wp.array2d(dtype=float),  # type: ignore[valid-type]
) -> None:
    i = wp.tid()
    about = Surroundings(
        x[i, 8], x[i, 9], x[i, 10], x[i, 11], x[i, 12], x[i, 13], x[i, 14], x[i, 15], x[i, 16]
    )
    body = inertia(p, about.load, about.mass)
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
    """States (state, 17): yaw, velocities, commands, lagged commands, surroundings."""
    random, x = np.random.default_rng(7), np.zeros((STATES, 17))
    x[:, 0] = random.uniform(-np.pi, np.pi, STATES)
    x[:, 1:4] = random.normal(size=(STATES, 3)) * (1.0, 1.0, 0.5)
    x[:, 4:8] = random.uniform(low, high, (STATES, 4))
    x[:, 8:12] = random.normal(size=(STATES, 4)) * (6.0, 6.0, 0.3, 0.3)
    x[:, 12] = random.integers(0, 50, STATES)
    x[:, 13:15] = random.choice((1.0, 0.7, 0.0), (STATES, 2), p=(0.8, 0.1, 0.1))
    x[:, 15:] = random.choice((1.0, 0.8, 1.25), (STATES, 2))
    edges = x[: STATES // 10]
    edges[:, 1:4] *= random.integers(0, 2, (len(edges), 3))  # at rest, not turning, along an axis
    edges[:, 8:12] *= random.integers(0, 2, (len(edges), 4))
    return x.astype(np.float32)


@pytest.mark.parametrize("name", vessel_names())
def test_accelerations_are_those_of_the_cpu(name: str) -> None:
    """To 1e-5 of the vector's length at 10,000 states; so is the slope of drag and thrust."""
    vessel = load_vessel(name)
    record: Any = pack(vessel)
    states = drawn(*vessel.thruster.command_range)
    out: Any = wp.zeros((STATES, 6), dtype=float, device="cpu")
    wp.launch(motions, STATES, [_given(record), wp.array(states, dtype=float, device="cpu"), out])
    known = np.empty((STATES, 6))
    for i, x in enumerate(states.astype(np.float64).tolist()):
        yaw, vx, vy, r, *commands = x[:8]
        about = vessel_motion.Surroundings(*x[8:])
        body = vessel_motion.inertia(record, about.load, about.mass)
        command, lagged = (commands[0], commands[1]), (commands[2], commands[3])
        known[i, :3] = vessel_motion.mean_acceleration(
            record, body, yaw, vx, vy, r, command, lagged, about, STEP_S
        )
        known[i, 3:] = vessel_motion.damping(record, yaw, vx, vy, r, lagged, about)
    found = out.numpy()
    for part in (slice(0, 3), slice(3, 6)):
        off = np.linalg.norm(found[:, part] - known[:, part], axis=1)
        assert (off <= 1e-5 * np.linalg.norm(known[:, part], axis=1) + 1e-12).all()


FLEET = ("otter", "scout", "forager", "ideal")
PLANS: dict[str, tuple[tuple[float, float, float], ...]] = {
    "straight": ((0.0, 0.2, 0.2), (40.0, 0.1, 0.1)),
    "turn": ((0.0, 0.6, 0.2),),
    "zigzag": (
        (0.0, 0.45, 0.45),
        *((15.0 + 5 * k, 0.15 + 0.3 * (k % 2), 0.45 - 0.3 * (k % 2)) for k in range(9)),
    ),
    "stop": ((0.0, 0.2, 0.2), (20.0, -0.2, -0.2), (25.0, 0.0, 0.0)),
}
"""From a time [s] on, shares of the command ahead, or astern, of port and starboard. Faster, no two
formats of numbers agree: hulls do not keep their course then, and any error grows."""
WEATHERS = {"calm": (0.0, 0.0, 0.0, 0.0), "wind": (5.0, -6.2, 0.2, -0.1)}


@pytest.fixture(scope="module")
def scene() -> Scene:
    return build_scene([load_vessel(name) for name in FLEET])


def test_a_minute_of_manoeuvres_is_that_of_the_cpu(scene: Scene) -> None:
    """Within 5 mm and .05 degrees: calm and windy, empty and laden.

    All manoeuvres are worlds of one batch, far apart where vessels could meet.
    """
    cases = [(p, w, load) for p in PLANS.values() for w in WEATHERS.values() for load in (0, 60)]
    worlds, low, high = len(cases), *np.array([v.thruster.command_range for v in scene.vessels]).T
    hulls, known = WarpHulls(scene, worlds), Simulation(scene, worlds)
    pose = np.zeros((worlds, len(FLEET), 3))
    pose[..., 0], pose[..., 2] = 200.0 * np.arange(len(FLEET)), 0.7
    weather = np.array([case[1] for case in cases])[:, None]
    aboard = np.array([[float(case[2])] for case in cases])
    known.place_vessels(pose)
    known.vessel_wind[:], known.vessel_water[:] = weather[..., :2], weather[..., 2:]
    known.load[:] = aboard
    hulls.place_vessels(pose)
    names = ("wind_x", "wind_y", "water_x", "water_y")
    hulls.surround(load=aboard, **{name: weather[..., k] for k, name in enumerate(names)})
    for step in range(600):
        shares = np.array([[c[1:] for c in case[0] if c[0] <= 0.1 * step][-1] for case in cases])
        each = shares[:, None]
        commands = np.where(each > 0, each * high[:, None], -each * low[:, None])
        known.commands[:] = commands
        hulls.command(commands)
        known.step()
        hulls.step()
        off = np.abs(hulls.vessel_pose - known.vessel_pose)
        assert off[..., :2].max() < 5e-3
        assert np.degrees(off[..., 2].max()) < 0.05
    assert np.abs(hulls.vessel_velocity - known.vessel_velocity).max() < 2e-3
    alone = WarpHulls(scene, 1)
    alone.place_vessels(pose[:1])
    alone.command(commands[:1])
    alone.step(3)
    again = WarpHulls(scene, 2)
    again.place_vessels(np.repeat(pose[:1], 2, axis=0))
    again.command(np.repeat(commands[:1], 2, axis=0))
    again.step(3)
    assert (again.vessel_pose == alone.vessel_pose).all()  # whatever the number of worlds


def test_what_it_cannot_do_is_one_line(scene: Scene) -> None:
    with pytest.raises(UserError, match="warp: a scene with 3 items"):
        WarpHulls(build_scene(scene.vessels, items=3))
    if not wp.is_cuda_available():
        with pytest.raises(UserError, match="device cuda: there is none here"):
            WarpHulls(scene, device="cuda")


def test_a_formula_of_somebody_else_is_not_compiled() -> None:
    with pytest.raises(ValueError, match="drawn: is not one of mjforage"):
        warped(drawn)
