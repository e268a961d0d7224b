"""Exported scenes, opened by a process that knows MuJoCo alone."""

import dataclasses
import itertools
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
import shapely
from numpy.typing import NDArray

import mjforage as mf
from mjforage.runs.episode_recording import Recording
from mjforage.scenario.debris import load_debris
from tests.mjforage.scenario.placing.drawn import geojson

ALONE = """
import json, sys, mujoco
model = mujoco.MjModel.from_xml_path(sys.argv[1])
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
opened = data.xpos.tolist()
mujoco.mj_resetDataKeyframe(model, data, 0)
mujoco.mj_forward(model, data)
start = data.xpos.tolist()
data.ctrl[:] = 1e9
mujoco.mj_forward(model, data)
forces = data.qfrc_actuator.tolist()
data.ctrl[:] = 0.0
for _ in range(100):
    mujoco.mj_step(model, data)
bodies = [model.body(i).name for i in range(model.nbody)]
quays = [g for g in range(model.ngeom) if model.geom(g).name.startswith("quay")]
print(json.dumps({
    "mjforage": any(name.startswith("mjforage") for name in sys.modules),
    "mass": dict(zip(bodies, model.body_mass.tolist())),
    "inertia_z": dict(zip(bodies, model.body_inertia[:, 2].tolist())),
    "opened": dict(zip(bodies, opened)),
    "start": dict(zip(bodies, start)),
    "forces": forces,
    "quays": [(data.geom_xpos[g].tolist(), model.geom_size[g].tolist()) for g in quays],
    "motors": {model.actuator(i).name: model.actuator_ctrlrange[i].tolist()
               for i in range(model.nu)},
    "time": data.time,
    "warnings": sum(one.number for one in data.warning),
    "key_time": model.key_time.tolist(),
    "key_qpos": model.key_qpos.tolist(),
}))
"""
SIX_DIGITS = 1e-5  # relative error of numbers in the file, at most


def opened(folder: Path) -> dict[str, Any]:
    """Return what a process without mjforage finds in a scene, and after 100 steps of it."""
    made = [sys.executable, "-I", "-c", ALONE, str(folder / "scene.xml")]
    done = subprocess.run(made, capture_output=True, check=True, text=True, cwd=folder)
    found: dict[str, Any] = json.loads(done.stdout)
    assert (found["mjforage"], found["warnings"]) == (False, 0)
    assert found["time"] == pytest.approx(2.0)
    return found


@pytest.fixture(scope="module")
def port() -> mf.Scenario:
    """Scenario whose vessels are not those of the files: heavier, another lever and weaker."""
    scout = dataclasses.replace(mf.load_vessel("scout"), name="tender", lever_m=0.25)
    physics = {"vessels": {"scouts": scout}, "scale": {"mass": 1.25, "thrust": 0.75}}
    return mf.load_scenario("comb-port", horizon=4, physics=physics)


@pytest.fixture(scope="module")
def scene(port: mf.Scenario, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return port.export(tmp_path_factory.mktemp("scene") / "port", "mjcf", seed=3, episode=2)


@pytest.fixture(scope="module")
def found(scene: Path) -> dict[str, Any]:
    return opened(scene)


def test_masses_are_those_of_the_scenario(found: dict[str, Any], port: mf.Scenario) -> None:
    for name, file in (("scouts_0", "scout"), ("foragers_1", "forager")):
        vessel = mf.load_vessel(file)
        assert found["mass"][f"{name}/hull"] == pytest.approx(1.25 * vessel.mass_kg, rel=SIX_DIGITS)
        spin = vessel.inertia_z_kgm2 - vessel.mass_kg * vessel.cog_x_m**2
        inertia = found["inertia_z"][f"{name}/hull"]
        assert inertia == pytest.approx(1.25 * spin, rel=SIX_DIGITS)
    (kind,) = {*port.scenario.physics.item_classes}
    mass = next(one.mass_kg for one in load_debris() if one.name == kind)
    items = [value for name, value in found["mass"].items() if name.startswith("item")]
    assert len(items) > 50
    assert items == pytest.approx([mass] * len(items), rel=SIX_DIGITS)


def test_quays_are_where_the_map_has_land(found: dict[str, Any], port: mf.Scenario) -> None:
    centre, half = np.array(found["quays"])[..., :2].transpose(1, 0, 2)
    water, pitch_m = port.map.water, port.map.pitch_m
    for row, column in np.ndindex(water.shape):
        point = np.array([column, len(water) - 1 - row]) * pitch_m
        assert (np.abs(point - centre) < half).all(axis=1).any() != water[row, column]


def test_motors_have_thrust_and_lever_of_the_vessel(found: dict[str, Any]) -> None:
    for name, file in (("scouts_1", "scout"), ("foragers_0", "forager")):
        low, high = mf.load_vessel(file).thruster.thrust_range
        for side in ("port", "starboard"):
            limits = found["motors"][f"{name}/{side}"]
            assert limits == pytest.approx((0.75 * low, 0.75 * high), rel=SIX_DIGITS)
    surge, _, turn = found["forces"][:3]
    assert surge == pytest.approx(2 * 0.75 * 33.6, rel=SIX_DIGITS)
    assert turn == pytest.approx(0.0, abs=1e-9)


def test_a_motor_alone_turns_with_its_lever(scene: Path) -> None:
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(scene / "scene.xml"))
    data = mujoco.MjData(model)
    data.ctrl[model.actuator("scouts_0/port").id] = 10.0
    mujoco.mj_forward(model, data)
    assert data.qfrc_actuator[:3] == pytest.approx((10.0, 0.0, -2.5))


def test_bodies_stand_at_the_start_of_the_episode(found: dict[str, Any], port: mf.Scenario) -> None:
    state = mf.make_mission(port).reset(seed=3, episode=2)
    names = [f"{name}/hull" for name in port.fleet.names]
    names += [f"item-{k}/item" for k in range(len(state.item_xy_m))]
    there = np.concatenate((state.agent_xy_m, state.item_xy_m))
    for when in ("opened", "start"):
        places = [found[when][name][:2] for name in names]
        np.testing.assert_allclose(places, there, rtol=SIX_DIGITS)
    assert found["key_time"] == [0.0]


def test_the_page_has_the_numbers_of_the_fleet_and_no_place_of_this_machine(scene: Path) -> None:
    assert {path.name for path in scene.iterdir()} == {"scene.xml", "tracks.csv", "README.md"}
    text = (scene / "README.md").read_text("utf-8")
    assert "| key | tender | forager | unit | meaning |" in text
    assert "| `added_mass_sway_kg` | 23.1 | 82.5 | kg |" in text
    assert "| `thruster.max_ahead_newton` | 25.2 | - | N |" in text
    assert "{" not in text.replace("{scenario", "")
    for path in scene.iterdir():
        words = path.read_text("utf-8")
        for place in (Path.home(), Path(mf.__file__).parents[1], scene.parent):
            assert str(place) not in words


def test_a_run_has_a_keyframe_per_decision_and_its_tracks(
    port: mf.Scenario, tmp_path: Path
) -> None:
    run = mf.evaluate(port, "greedy", episodes=2, seed=3, world="physics", record=[1])
    folder = run.export(tmp_path / "run", "mjcf", episode=1)
    found, shown = opened(folder), run.recording(episode=1)
    assert found["key_time"] == [0.0, 10.0, 20.0, 30.0, 40.0]
    rows, vessels = len(port.map.water), len(port.fleet)
    keys = np.array(found["key_qpos"])
    poses = keys[:, : 3 * vessels].reshape(-1, vessels, 3)
    there = np.stack((shown.agent_rc[..., 1], rows - 1 - shown.agent_rc[..., 0]), axis=2)
    np.testing.assert_allclose(poses[..., :2], 4.0 * there, rtol=SIX_DIGITS)
    tracks = pl.read_csv(folder / "tracks.csv")
    frames = tracks.filter(pl.col("t_s") % 10.0 == 0.0)
    assert frames["vessel"].to_list() == list(shown.labels) * 5
    read = frames.select("x_m", "y_m", "yaw_rad").to_numpy().reshape(poses.shape)
    np.testing.assert_allclose(poses, read, rtol=SIX_DIGITS, atol=1e-9)
    assert np.ptp(read[..., 2]) > 0.1
    assert len(tracks) == vessels * len(shown.track_pose)


def test_items_that_are_gone_lie_apart(port: mf.Scenario, tmp_path: Path) -> None:
    from mjforage.runs.exporting import write_export

    shown: Recording = mf.evaluate(port, "greedy", episodes=1, record=[0]).recording()
    gone = shown.track_present.copy()
    gone[-1, 3] = False
    folder = tmp_path / "gone"
    write_export(port, lambda: dataclasses.replace(shown, track_present=gone), folder, "mjcf")
    keys = np.array(opened(folder)["key_qpos"])[:, 3 * len(port.fleet) :].reshape(5, -1, 2)
    assert (keys[:4, 3] > -4.0).all()
    assert (keys[4, 3] < -40.0).all()


def test_a_scene_of_a_place_has_its_walls(tmp_path: Path) -> None:
    """Thin boxes along the outline, which hold hulls; cells of land hold items alone."""
    import mujoco

    shape = shapely.affinity.rotate(shapely.box(-30, -20, 30, 20), 30.0)
    source = geojson(tmp_path / "basin.geojson", [(shape, {"natural": "water"})])
    bay = mf.load_scenario("open-bay", map=mf.Map.of_chart(source, tmp_path / "port"), horizon=4)
    assert bay.map.place is not None
    folder = bay.export(tmp_path / "scene", "mjcf")
    model = mujoco.MjModel.from_xml_path(str(folder / "scene.xml"))
    data = mujoco.MjData(model)
    named = [(model.geom(g).name, g) for g in range(model.ngeom)]
    walls = [g for name, g in named if name.startswith("quay")]
    (ring,) = [np.array(ring) for ring in bay.map.place.quays if len(ring) == 5][-1:]
    mujoco.mj_forward(model, data)

    def covered(xy: NDArray[np.float64]) -> NDArray[np.bool_]:
        off = xy[:, None] - data.geom_xpos[walls, :2]
        along = np.einsum("pgi,gij->pgj", off, data.geom_xmat.reshape(-1, 3, 3)[walls, :2, :2])
        inside = (np.abs(along) < model.geom_size[walls, :2] + 1e-4).all(axis=2)
        return np.asarray(inside.any(axis=1))

    for start, end in itertools.pairwise(ring):
        way = (end - start) / np.hypot(*(end - start))
        line = start + np.linspace(1.0, 39.0, 20)[:, None] * way
        for off_m, inside in ((0.0, True), (0.045, True), (0.06, False), (-0.06, False)):
            assert (covered(line + off_m * np.array([-way[1], way[0]])) == inside).all()
    middle = 0.5 * (ring[0] + ring[1])
    for where, hits in ((middle, {"quay"}), (np.zeros(2), set())):  # the corner cell is land
        data.qpos[:2] = where
        mujoco.mj_forward(model, data)
        pairs = [{model.geom(g).name for g in pair} for pair in data.contact.geom]
        met = set().union(*(pair for pair in pairs if "scouts_0/collider" in pair))
        assert {name.split("-")[0] for name in met if "quay" in name or "bank" in name} == hits


def test_a_folder_that_holds_something_is_refused(port: mf.Scenario, scene: Path) -> None:
    before = (scene / "scene.xml").read_bytes()
    with pytest.raises(mf.UserError, match="port: is not empty; name another"):
        port.export(scene, "mjcf")
    assert (scene / "scene.xml").read_bytes() == before
    with pytest.raises(mf.UserError, match="format obj: unknown; choose mjcf"):
        port.export(scene, "obj")
