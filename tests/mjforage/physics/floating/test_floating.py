"""Items that drift in our kernel do what they do in MuJoCo, and go over without a jump."""

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import (
    InstabilityError,
    Integrator,
    Simulation,
    simulated_fleet,
    simulation,
)
from mjforage.physics.vessels import load_vessel

BOTH = pytest.mark.parametrize("integrator", Integrator)
FORAGER = load_vessel("forager")
BASIN = np.ones((7, 9), np.bool_)
PIER = BASIN.copy()
PIER[3, 4] = False
ITEMS, RUNS = 60, 2
NEVER, ALWAYS = -1e9, 1e9  # speeds of approach for which no item, or every item, has a body


def scattered(
    water: NDArray[np.bool_],
    integrator: Integrator,
    closing_mps: float,
    monkeypatch: pytest.MonkeyPatch,
    bodies: int = ITEMS + simulation.POOL_SPARE,
) -> Simulation:
    """Items of all classes all over a basin and a little way onto its quays, and a vessel."""
    scene = build_scene([FORAGER], navigable=water, pitch_m=4.0, items=bodies)
    with monkeypatch.context() as patch:
        patch.setattr(simulated_fleet, "CLOSING_MPS", closing_mps)
        sim = Simulation(scene, RUNS, integrator=integrator, step_s=0.1, items=ITEMS)
    rng = np.random.default_rng(1)
    rows, cols = np.nonzero(water)
    cell = rng.integers(0, len(rows), (RUNS, ITEMS))
    at = np.stack((cols[cell], water.shape[0] - 1 - rows[cell]), axis=-1) * 4.0
    at[:, ::4] = 6.0, 6.0  # about a quarter of them before the bow
    at += rng.uniform(-2.05, 2.05, at.shape)
    at[:, 1], at[:, 2] = (-2.3, 9.0), (17.6, 12.3)  # in the west edge; in the pier, if there is one
    sim.place_items(at, rng.integers(0, 5, (RUNS, ITEMS)))
    sim.place_vessels(np.array([4.0, 4.0, 0.5]))
    return sim


def blow(
    sim: Simulation, seconds: float, *, drive: bool
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Turning, gusty wind and a current; the vessel drives about, or lies far away.

    Returns
    -------
    (step, simulation, item, 4) places [m] and velocities [m/s] of the items on the way, and (step,)
    how many of them had bodies
    """
    rng, way, active = np.random.default_rng(2), [], []
    if not drive:
        sim.place_vessels(np.array([900.0, 900.0, 0.0]))
    for k in range(round(seconds / 0.1)):
        if k % 5 == 0:
            toward, speed = 0.004 * k + rng.normal(0.0, 0.2), rng.uniform(4.0, 12.0)
            sim.item_wind[:] = speed * np.array((np.cos(toward), np.sin(toward)))
            sim.item_water[:] = 0.1, -0.05
            sim.commands[:] = rng.uniform(-40.0, 90.0, 2) if drive else 0.0
        sim.step(1)
        active.append(sim._afloat.active.sum())
        way.append(np.concatenate((sim.item_xy, sim.item_velocity), axis=-1))
    return np.array(way), np.array(active)


@BOTH
@pytest.mark.parametrize("water", [BASIN, PIER], ids=["basin", "pier"])
def test_items_move_as_in_mujoco(
    water: NDArray[np.bool_], integrator: Integrator, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Freely, onto quays, along them, into corners, around the corners of a pier, out of land."""
    ours, mujocos = (scattered(water, integrator, v, monkeypatch) for v in (NEVER, ALWAYS))
    (way, none), (expected, all_of_them) = (blow(s, 150.0, drive=False) for s in (ours, mujocos))
    assert none.max() == 0 and all_of_them.min() == RUNS * ITEMS
    np.testing.assert_allclose(way, expected, rtol=0, atol=1e-7)
    assert np.median(np.hypot(*np.moveaxis(way[-1] - way[0], -1, 0)[:2])) > 2.0


@BOTH
def test_items_go_over_to_mujoco_and_back_without_a_jump(
    integrator: Integrator, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A vessel that drives through them still pushes some and pins some to quays."""
    active = scattered(BASIN, integrator, simulated_fleet.CLOSING_MPS, monkeypatch, bodies=3)
    all_bodies = scattered(BASIN, integrator, ALWAYS, monkeypatch)
    unpushed = scattered(BASIN, integrator, NEVER, monkeypatch)
    ways, bodies = zip(
        *(blow(sim, 60.0, drive=True) for sim in (active, all_bodies, unpushed)), strict=True
    )
    assert bodies[0].min() < bodies[0].max() < bodies[1].min() == RUNS * ITEMS
    np.testing.assert_allclose(active.vessel_pose, all_bodies.vessel_pose, rtol=0, atol=1e-6)
    np.testing.assert_allclose(ways[0], ways[1], rtol=0, atol=1e-6)
    pushed = np.abs(ways[0] - ways[2])[-1, ..., :2].max(axis=-1) > 0.05
    assert pushed.sum() >= 3
    assert 3 < active.scene.items < ITEMS


def test_water_that_is_no_number_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    sim = scattered(BASIN, Integrator.FAST, NEVER, monkeypatch)
    sim.step(10)
    sim.item_water[1, 7, 0] = np.nan
    with pytest.raises(InstabilityError, match=r"unstable at seed 1, t = 1.1. s, item 7; check"):
        sim.step(10)


def test_more_items_near_vessels_than_bodies_can_be_are_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(simulation, "MOST_BODIES", 12)
    sim = scattered(BASIN, Integrator.FAST, ALWAYS, monkeypatch, bodies=4)
    with pytest.raises(UserError, match=r"physics: 60 items within .* at most 12 .*items = graph"):
        sim.step(1)


@BOTH
def test_each_item_goes_with_its_own_wind_and_water(integrator: Integrator) -> None:
    """Of six beside a hull, which have bodies, and six far away; one of each is not there.

    From rest an item sets out along a |W| W + b |c| c.
    """
    scene = build_scene([load_vessel("scout")], items=8)
    simulation, rng = (
        Simulation(scene, 2, integrator=integrator, items=12),
        np.random.default_rng(4),
    )
    xy = np.array([(0.25 * k - 0.6, 0.9 + 20.0 * (k > 5)) for k in range(12)])
    kind = np.tile(np.arange(12) % len(scene.classes), (2, 1))
    kind[0, [0, 7]] = kind[1, [2, 6]] = -1
    simulation.place_items(xy, kind)
    wind, water = rng.normal(0.0, 3.0, (2, 12, 2)), rng.normal(0.0, 0.2, (2, 12, 2))
    simulation.item_wind[:], simulation.item_water[:] = wind, water
    simulation.step()
    assert (simulation._afloat.active.sum(axis=1) == 5).all()
    air, by_water = (
        np.array([getattr(each, name) for each in scene.classes])[kind, None]
        * np.linalg.norm(flow, axis=-1, keepdims=True)
        * flow
        for name, flow in (("air", wind), ("water", water))
    )
    course = np.arctan2(*np.moveaxis(air + by_water, -1, 0)[::-1])
    gone = np.arctan2(*np.moveaxis(simulation.item_velocity, -1, 0)[::-1])
    off = np.angle(np.exp(1j * (gone - course)))[kind >= 0]
    assert np.abs(off).max() < 0.05
