"""Missions with hulls in Warp: items beside hulls, any batch, the door, and what it refuses."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import warp as wp

import mjforage as mf
from mjforage.base.errors import UserError
from mjforage.physics.floating.beside_hulls import out_of_box
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import InstabilityError, Simulation
from mjforage.physics.vessels import load_vessel
from mjforage.physics.warp_simulation import WarpSimulation
from mjforage.runs.layout import DEVICE_CHUNK, plan

ITEMS = 30


@pytest.fixture(scope="module")
def pushing() -> tuple[Simulation, WarpSimulation]:
    """A forager that goes ahead among items, in two runs; a quay lies ahead."""
    scene = build_scene(
        [load_vessel("forager")], navigable=np.ones((5, 11), np.bool_), pitch_m=4.0, items=8
    )
    both = Simulation(scene, 2, items=ITEMS), WarpSimulation(scene, 2, items=ITEMS)
    random = np.random.default_rng(3)
    x, y = random.uniform(4.0, 16.0, (2, ITEMS)), random.uniform(6.8, 9.2, (2, ITEMS))
    kinds = random.integers(0, len(scene.classes), (2, ITEMS))
    for sim in both:
        sim.place_vessels(np.array([2.0, 8.0, 0.0]))
        sim.place_items(np.stack((x, y), axis=-1), kinds)
        sim.vessel_wind[:] = sim.item_wind[:] = 0.5
        sim.spread[0] = 0.2, -0.3, -0.25
        sim.commands[:] = 0.5 * scene.vessels[0].thruster.command_range[1]
    return both


def test_a_hull_pushes_points_as_it_pushes_bodies(
    pushing: tuple[Simulation, WarpSimulation],
) -> None:
    """Within 5 cm on a way of 6 m among items, and the hull within 2 cm; 32 cm if it felt none."""
    known, found = pushing
    start = known.item_xy
    for _ in range(90):
        known.step()
        found.step()
    way = known.item_xy - start
    pushed = np.linalg.norm(way - np.median(way, axis=1)[:, None], axis=-1)
    assert (pushed > 0.2).sum() >= 8
    assert np.linalg.norm(found.item_xy - known.item_xy, axis=-1).max() < 0.05
    assert np.abs(found.vessel_pose - known.vessel_pose)[..., :2].max() < 0.02
    assert known.vessel_pose[..., 0].min() > 7.0
    assert np.abs(np.diff(known.vessel_pose, axis=0)).max() > 0.05  # one weighs and draws less


def test_the_nearest_way_out_of_a_hull() -> None:
    """Of a box of 2 m x 1 m: depth, and the way to the nearest point of its sides."""
    edge = np.linspace(-1.0, 1.0, 4001)
    sides = np.concatenate(
        [np.stack((edge, np.full_like(edge, s)), 1) * (1.0, 0.5) for s in (-1.0, 1.0)]
        + [np.stack((np.full_like(edge, s), edge), 1) * (1.0, 0.5) for s in (-1.0, 1.0)]
    )
    for x, y in np.random.default_rng(0).uniform(-1.5, 1.5, (300, 2)):
        away = np.linalg.norm(sides - (x, y), axis=1)
        inside = abs(x) < 1.0 and abs(y) < 0.5
        depth, out_x, out_y = out_of_box(x, y, 1.0, 0.5)
        assert depth == pytest.approx(away.min() if inside else -away.min(), abs=1e-3)
        assert np.hypot(out_x, out_y) == pytest.approx(1.0)
        to = (x + depth * out_x, y + depth * out_y)
        assert np.linalg.norm(sides - to, axis=1).min() < 1e-3


def test_simulations_that_wait_or_restart_leave_no_bit(
    pushing: tuple[Simulation, WarpSimulation],
) -> None:
    sim = pushing[1]
    before = sim.vessel_pose, sim.item_xy, sim.time_s.copy()
    sim.step(ids=np.array([1]))
    after = sim.vessel_pose, sim.item_xy, sim.time_s
    for a, b in zip(before, after, strict=True):
        assert (a[0] == b[0]).all()
        assert (a[1] != b[1]).any()
    sim.vessel_wind[0] = np.nan
    with pytest.raises(InstabilityError, match=r"unstable at seed 0, t = .* s, body forager_0"):
        sim.step()
    sim.restart(np.array([0]), ["7"], ITEMS)
    sim.step()
    assert (sim.vessel_pose[0] == 0.0).all()


def play(episodes: list[int]) -> Any:
    mission = mf.make_mission(
        "comb-port-weather", world="physics", device="warp-cpu", batch=len(episodes), horizon=4
    )
    mission.reset(seed=5, episode=episodes)
    return list(mission.play("greedy"))[-1]


def test_a_mission_has_the_same_bits_in_any_batch() -> None:
    every, one = play([0, 1, 2]), play([1])
    assert (every.agent_xy_m[1] == one.agent_xy_m[0]).all()
    np.testing.assert_array_equal(every.item_xy_m[1], one.item_xy_m[0])
    cpu = mf.make_mission("comb-port-weather", world="physics", batch=3, horizon=4)
    cpu.reset(seed=5)
    known = list(cpu.play("greedy"))[-1]
    assert 0.0 < np.median(np.abs(known.agent_xy_m - every.agent_xy_m)) < 0.05


def test_the_device_is_part_of_a_run(tmp_path: Path) -> None:
    def told(device: str) -> Any:
        how: Any = {"device": device, "folder": tmp_path / device}
        mf.evaluate("comb-port", "greedy", episodes=1, world="physics", horizon=1, **how)
        return json.loads((tmp_path / device / "run.json").read_text("utf-8"))

    known, found = told("cpu"), told("warp-cpu")
    assert known["hash"] != found["hash"]
    assert found["scenario"]["physics"]["device"] == "warp-cpu"
    assert {"mujoco-warp", "warp-lang"} <= found["versions"].keys() - known["versions"].keys()
    (chunk,) = plan(["greedy"], ["physics"], DEVICE_CHUNK, device="warp-cpu")
    assert chunk.count == DEVICE_CHUNK


def test_what_does_not_go_on_a_device_is_one_line() -> None:
    def refused(**options: Any) -> str:
        with pytest.raises(UserError) as error:
            mf.make_mission("comb-port", **{"world": "physics", **options})
        return str(error.value)

    assert refused(device="gpu").startswith("device 'gpu': unknown")
    assert "the graph world has no hulls" in refused(device="warp-cpu", world="graph")
    assert "threads 2: a device" in refused(device="warp-cpu", threads=2, batch=2)
    slow = {"physics.integrator": "reference"}
    assert "has the fast integrator only" in refused(device="warp-cpu", **slow)
    if not wp.is_cuda_available():
        assert refused(device="cuda") == (
            "device cuda: there is none here; give warp-cpu, or no device"
        )


def test_a_device_without_its_extra_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(UserError, match=r"device warp-cpu: needs mujoco_warp; .*mjforage\[gpu\]"):
        mf.make_mission("comb-port", world="physics", device="warp-cpu")
