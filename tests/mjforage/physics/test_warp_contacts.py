"""Contacts of hulls in Warp against the CPU's: quays, corners, each other; room for contacts."""

from typing import Any

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.physics.scene import Scene, build_scene
from mjforage.physics.simulation import Simulation
from mjforage.physics.vessels import load_vessel
from mjforage.physics.warp_hulls import WarpHulls

FLEET = ("otter", "scout", "forager", "ideal")
SIDE_M, STEPS = 44.0, 150
LOW, HIGH = -2.0, SIDE_M - 2.0  # of the map's edges
TRIALS: dict[str, tuple[float, list[tuple[float, float, float]]]] = {
    # share of the thrust ahead; x, y [m], heading [deg] of each vessel
    "push": (0.3, [(HIGH - 3, 10.0 * k, 0.0) for k in range(4)]),
    "ram": (1.0, [(HIGH - 12, 10.0 * k, 0.0) for k in range(4)]),
    "deep": (0.3, [(HIGH - 0.6, 10.0 * k, 0.0) for k in range(4)]),
    "corner": (
        1.0,
        [
            (HIGH - 6, HIGH - 6, 45.0),
            (LOW + 6, HIGH - 6, 135.0),
            (LOW + 6, LOW + 6, 225.0),
            (HIGH - 6, LOW + 6, 315.0),
        ],
    ),
    "glance": (0.7, [(10.0 * k, HIGH - 2.0 - k, 25.0 + 5 * k) for k in range(4)]),
    "head on": (0.5, [(10, 10, 0.0), (18, 10, 180.0), (10, 30, 0.0), (18, 30, 180.0)]),
    "aside": (0.5, [(10, 10, 0.0), (16, 4, 90.0), (10, 30, 0.0), (16, 24, 90.0)]),
}


@pytest.fixture(scope="module")
def scene() -> Scene:
    fleet = [load_vessel(name) for name in FLEET]
    return build_scene(fleet, navigable=np.ones((11, 11), np.bool_), pitch_m=4.0)


def placed() -> Any:
    """(trial, vessel, 3) poses."""
    pose = np.array([case[1] for case in TRIALS.values()], np.float64)
    pose[..., 2] = np.radians(pose[..., 2])
    return pose


def commanded(scene: Scene) -> Any:
    """(trial, vessel, 2) commands."""
    top = np.array([vessel.thruster.command_range[1] for vessel in scene.vessels])
    share = np.array([case[0] for case in TRIALS.values()])
    return np.repeat((share[:, None] * top)[..., None], 2, axis=2)


def driven(scene: Scene, trials: list[int]) -> WarpHulls:
    """Hulls in some of the trials, at the start."""
    hulls = WarpHulls(scene, len(trials))
    hulls.place_vessels(placed()[trials])
    hulls.command(commanded(scene)[trials])
    return hulls


def test_hulls_meet_as_on_the_cpu(scene: Scene) -> None:
    """Depth of ramming and all places within 1 cm at any time, forces at rest within 3 %."""
    hulls, known = driven(scene, list(range(len(TRIALS)))), Simulation(scene, len(TRIALS))
    force = known.engine.bind("qfrc_constraint")  # filled by the steps that follow
    known.place_vessels(placed())
    known.commands[:] = commanded(scene)
    touched = np.zeros(len(TRIALS), np.bool_)
    for _ in range(STEPS):
        hulls.step()
        known.step()
        off = np.abs(hulls.vessel_pose - known.vessel_pose)
        assert off[..., :2].max() < 0.01
        assert np.degrees(off[..., 2].max()) < 1.0
        touched |= force.any(axis=1)
    assert touched.all()
    found, wanted = (np.linalg.norm(f.reshape(-1, 3)[:, :2], axis=1) for f in (hulls.force, force))
    assert (wanted > 20.0).sum() >= 21
    assert (np.abs(found - wanted) <= 0.03 * wanted + 0.1).all()


def test_bits_do_not_depend_on_the_worlds_beside(scene: Scene) -> None:
    """Nor on what these worlds did before."""
    every = driven(scene, list(range(len(TRIALS))))
    every.step(90)
    one, two = driven(scene, [3]), driven(scene, [6, 3])
    one.step(90)
    two.step(90)
    assert (one.vessel_pose[0] == every.vessel_pose[3]).all()
    assert (two.vessel_pose[1] == every.vessel_pose[3]).all()
    two.place_vessels(placed()[[3, 6]])
    two.command(commanded(scene)[[3, 6]])
    two.step(90)
    assert (two.vessel_pose == every.vessel_pose[[3, 6]]).all()


def test_contacts_without_room_are_an_error(scene: Scene) -> None:
    hulls = WarpHulls(scene, 1, contacts=6)
    hulls.place_vessels(placed()[:1])
    hulls.command(commanded(scene)[:1])
    with pytest.raises(UserError, match="more than 6 contacts of a world's hulls"):
        hulls.step(60)
