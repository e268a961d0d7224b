"""Visual scene of a recording: a MuJoCo model with its bodies at the positions of the track.

Nothing in it moves by itself: vessels and items are mocap bodies without joints, and the model
lacks the numbers by which the force callback knows its own, so drawing calls no physics. The water
is not in it; `water.py` paints it over the picture.
"""

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.physics.scene.mjcf import compiled, shipped_part
from mjforage.physics.scene.vessel_bodies import hull_part
from mjforage.physics.vessels import Vessel, load_vessel
from mjforage.runs.episode_recording import Recording
from mjforage.scenario.debris import load_debris
from mjforage.view.render.cameras import View
from mjforage.view.render.palette import Colour, agent_colours
from mjforage.view.render.scenery import add_scenery

Floats = NDArray[np.float64]
MAST = "bow"  # camera of an MJCF part from which its vessel looks
_DEFAULT_MAST = np.array([0.0, 0.0, 1.0])  # [m] of a part without one
_HIDDEN_Z = -200.0  # [m]
_SINK_M = 0.4  # how deep a collected item sinks while it vanishes, in life size
_LIFT_M = 0.08  # that an item drawn twice its size floats higher
_DIM = np.array([0.85, 0.85, 0.85, 1.0])  # brightness of items that nobody has discovered yet
_GEOM_SLICES = 16  # of round shapes; fewer draw faster
_FAR_M = 4000.0
_SUN = (-0.45, 0.55, -0.70)  # the way that light goes


def vessels_of(recording: Recording) -> tuple[Vessel, ...]:
    """Parameters of each vessel."""
    kinds = {name: load_vessel(name) for name in dict.fromkeys(recording.vessels)}
    return tuple(kinds[name] for name in recording.vessels)


class VisualScene:
    """Vessels and debris, larger than life by the given factors, and the scenery around them.

    Attributes
    ----------
    model : for drawing only
    vessels : (agent,)
    masts : (agent, 3) place of each vessel's own camera, in its axes and life size [m]
    """

    def __init__(self, recording: Recording, vessel_scale: float, item_scale: float) -> None:
        self.vessels = vessels_of(recording)
        self._item_scale, self._lift = item_scale, _LIFT_M * (item_scale - 1.0)
        spec = mujoco.MjSpec()
        spec.stat.extent, spec.stat.center = 1.0, [0, 0, 0]
        _light(spec)
        colours = agent_colours(recording.agent_collects.tolist())
        parts = zip(self.vessels, recording.labels, colours, strict=True)
        self.masts = np.array([_add_vessel(spec, *one, vessel_scale) for one in parts])
        _add_items(spec, recording.item_class, item_scale)
        add_scenery(spec, recording.navigable, recording.pitch_m, recording.quays)
        self.model = model = compiled(spec, "visual scene")
        model.vis.quality.offsamples, model.vis.quality.shadowsize = 0, 0
        model.vis.quality.numslices, model.vis.quality.numstacks = _GEOM_SLICES, _GEOM_SLICES // 2
        items = [model.body(f"item-{k}/item") for k in range(len(recording.item_class))]
        self._geoms = [one.geomadr[0] + np.arange(one.geomnum[0]) for one in items]
        self._colours = [model.mat_rgba[model.geom_matid[geoms]] for geoms in self._geoms]
        hulls = [model.body(f"{label}/hull") for label in recording.labels]
        self._bodies = [int(body.mocapid[0]) for body in (*hulls, *items)]
        self._data = mujoco.MjData(model)
        self._scene = mujoco.MjvScene(model, model.ngeom + 64)
        self._option, self._camera = mujoco.MjvOption(), mujoco.MjvCamera()
        self._option.geomgroup[:] = (1, 1, 1, 0, 0, 0)
        for flag in (mujoco.mjtRndFlag.mjRND_SHADOW, mujoco.mjtRndFlag.mjRND_SKYBOX):
            self._scene.flags[flag] = 0

    def place(self, hulls: Floats, items: Floats, known: NDArray[np.bool_]) -> None:
        """Put everything in its place.

        Parameters
        ----------
        hulls : (agent, 6) x, y, z [m], roll, pitch, yaw [rad]
        items : (item, 6) x, y, z [m], yaw [rad], tilt [rad], how much is there 0..1
        known : (item,) whether it is discovered
        """
        left = items[:, 5]
        sunk = items[:, 2] + self._lift - (1.0 - left) * _SINK_M * self._item_scale
        height = np.where(left > 0.0, sunk, _HIDDEN_Z)
        angles = np.column_stack((items[:, 3:5], np.zeros(len(items))))
        places = np.concatenate((hulls[:, :3], np.column_stack((items[:, :2], height))))
        turns = np.concatenate((hulls[:, [5, 4, 3]], angles))
        for number, place, turn in zip(self._bodies, places, turns, strict=True):
            self._data.mocap_pos[number] = place
            mujoco.mju_euler2Quat(self._data.mocap_quat[number], turn, "zyx")
        for geoms, colour, bright in zip(self._geoms, self._colours, known, strict=True):
            self.model.geom_rgba[geoms] = colour if bright else colour * _DIM
        mujoco.mj_kinematics(self.model, self._data)
        mujoco.mj_camlight(self.model, self._data)
        everything = mujoco.mjtCatBit.mjCAT_ALL.value
        drawn = self._option, None, self._camera, everything, self._scene
        mujoco.mjv_updateScene(self.model, self._data, *drawn)

    def seen(self, view: View, aspect: float, near_m: float) -> mujoco.MjvScene:
        """The scene from a view; drawn at once, as the next call changes it."""
        half = near_m * np.tan(0.5 * view.fov_rad)
        for camera in self._scene.camera:
            camera.pos, camera.forward, camera.up = view.eye, view.forward, view.up
            camera.frustum_center, camera.frustum_width = 0.0, half * aspect
            camera.frustum_bottom, camera.frustum_top = -half, half
            camera.frustum_near, camera.frustum_far = near_m, _FAR_M
        return self._scene


def _light(spec: mujoco.MjSpec) -> None:
    """A warm sun and blue light from the sky; no shadows, which would double the work."""
    light = spec.worldbody.add_light(name="sun", dir=_SUN, castshadow=False)
    light.type = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    light.diffuse, light.specular = [0.66, 0.63, 0.56], [0.25, 0.25, 0.25]
    light.ambient = [0.36, 0.40, 0.46]
    spec.visual.headlight.ambient = [0.06, 0.06, 0.06]
    spec.visual.headlight.diffuse = [0.10, 0.10, 0.10]
    spec.visual.headlight.specular = [0, 0, 0]


def _add_vessel(
    spec: mujoco.MjSpec, vessel: Vessel, label: str, colour: Colour, scale: float
) -> Floats:
    """Attach the visible parts of one vessel, its hull in its colour; return its mast."""
    part = hull_part(vessel).copy()
    masts = [np.array(camera.pos) for camera in part.cameras if camera.name == MAST]
    material = part.material("hull")
    if material is not None:
        material.rgba = [*(channel / 255.0 for channel in colour), 1.0]
    body = spec.worldbody.add_frame().attach_body(part.body("hull"), f"{label}/", "")
    _freeze(spec, body, scale)
    return masts[0] if masts else _DEFAULT_MAST


def _freeze(spec: mujoco.MjSpec, body: mujoco.MjsBody, scale: float, appearance: str = "") -> None:
    """Keep what is seen of a body and named so, larger by `scale`; it stands where it is put."""
    for part in (*body.joints, *body.sites, *body.cameras):
        spec.delete(part)
    body.mocap = True
    for geom in list(body.geoms):
        if geom.contype or geom.conaffinity or not geom.name.startswith(appearance):
            spec.delete(geom)
            continue
        geom.size, geom.pos = scale * geom.size, scale * geom.pos
        geom.fromto = scale * geom.fromto


def _add_items(spec: mujoco.MjSpec, classes: NDArray[np.int16], scale: float) -> None:
    """One body per item, with the appearance of its class."""
    part, names = shipped_part("debris"), [kind.name for kind in load_debris()]
    worn = {geom.name: geom.material for geom in part.body("item").geoms}
    for geom in part.body("item").geoms:
        geom.material = ""
    for one in list(part.materials):  # MuJoCo draws no more than 1,000: items share theirs
        look = {"rgba": one.rgba, "specular": one.specular, "shininess": one.shininess}
        spec.add_material(name=one.name, **look)
        part.delete(one)
    parts = {kind: part.copy() for kind in set(classes.tolist())}
    for kind, own in parts.items():  # what is deleted later costs a whole scene
        _freeze(own, own.body("item"), scale, names[kind])
    for k, kind in enumerate(classes.tolist()):
        frame, own = spec.worldbody.add_frame(), parts[kind].copy()
        for geom in frame.attach_body(own.body("item"), f"item-{k}/", "").geoms:
            geom.material = worn[geom.name.removeprefix(f"item-{k}/")]


def distance_ahead(depth: NDArray[np.float32], near_m: float) -> NDArray[np.float32]:
    """Distances [m] along the view from depths 0..1 of a perspective picture; far is infinite."""
    near, far = np.float32(near_m), np.float32(_FAR_M)
    ahead: NDArray[np.float32] = near * far / (far - depth * (far - near))
    ahead[depth >= 1.0] = np.inf
    return ahead


def mirrored(view: View) -> View:
    """The view of things above the water as the water mirrors them, its picture upside down."""
    flip = np.array([1.0, 1.0, -1.0])
    return View(flip * view.eye, flip * view.forward, -flip * view.up, view.fov_rad)
