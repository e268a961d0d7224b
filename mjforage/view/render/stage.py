"""What MuJoCo draws of a replay: a model of looks only, whose bodies are put where the track says.

Nothing in it moves by itself: hulls and items are mocap bodies without joints, and the model lacks
the numbers by which the force callback knows its own, so drawing calls no physics. The water is
not in it; `water.py` paints it over the picture.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.physics.scene.debris import load_debris
from mjforage.physics.scene.mjcf import compiled, shipped_part
from mjforage.physics.scene.vessel_bodies import hull_part
from mjforage.physics.vessels import Vessel, load_vessel
from mjforage.runs.episode_recording import Recording
from mjforage.view.render import harbour, sheds, textures
from mjforage.view.render.cameras import View
from mjforage.view.render.palette import Colour, agent_colours

Floats = NDArray[np.float64]
MAST = "bow"  # camera of an MJCF part from which its vessel looks
_DEFAULT_MAST = (0.0, 0.0, 1.0)  # [m] of a part without one
_HIDDEN_Z = -200.0  # [m]
_SINK_M = 0.4  # how deep a collected item sinks while it vanishes, in life size
_LIFT_M = 0.08  # that an item drawn twice its size floats higher
_DIM = 0.85  # brightness of items that nobody has discovered yet
_GEOM_SLICES = 16  # of round shapes; fewer draw faster
_FAR_M = 4000.0
_SUN = (-0.45, 0.55, -0.70)  # the way that light goes


@dataclass(frozen=True, eq=False)
class Look:
    """A compiled stage and where its movable parts are.

    Attributes
    ----------
    model : of looks only
    labels : (agent,) names of the vessels
    vessels : (agent,)
    masts : (agent, 3) where each one's own camera sits, in its axes and life size [m]
    hulls, items : (agent,), (item,) mocap numbers
    item_geoms : (item,) slices of geoms
    """

    model: mujoco.MjModel
    labels: tuple[str, ...]
    vessels: tuple[Vessel, ...]
    masts: Floats
    hulls: NDArray[np.int64]
    items: NDArray[np.int64]
    item_geoms: tuple[NDArray[np.int64], ...]


def vessels_of(replay: Recording) -> tuple[tuple[Vessel, ...], tuple[str, ...]]:
    """The hulls of a replay and their names, such as ``scouts_0``."""
    kinds = {name: load_vessel(name) for name in dict.fromkeys(replay.vessels)}
    vessels = tuple(kinds[name] for name in replay.vessels)
    return vessels, replay.labels


def build_look(replay: Recording, hull_scale: float, item_scale: float) -> Look:
    """Build the stage of a replay, hulls and debris larger than life by the given factors."""
    vessels, labels = vessels_of(replay)
    spec = mujoco.MjSpec()
    spec.stat.extent, spec.stat.center = 1.0, [0, 0, 0]
    _light(spec)
    colours = agent_colours(replay.agent_collects.tolist())
    masts = [
        _add_hull(spec, vessel, label, hull_scale, colour)
        for vessel, label, colour in zip(vessels, labels, colours, strict=True)
    ]
    _add_items(spec, replay.item_class, item_scale)
    _add_harbour(spec, replay.navigable, replay.pitch_m)
    model = compiled(spec, "stage")
    model.vis.quality.offsamples, model.vis.quality.shadowsize = 0, 0
    model.vis.quality.numslices, model.vis.quality.numstacks = _GEOM_SLICES, _GEOM_SLICES // 2
    bodies = [model.body(f"item-{k}/item") for k in range(len(replay.item_class))]
    return Look(
        model,
        labels,
        vessels,
        np.array(masts),
        np.array([model.body(f"{label}/hull").mocapid[0] for label in labels]),
        np.array([body.mocapid[0] for body in bodies], np.int64),
        tuple(body.geomadr[0] + np.arange(body.geomnum[0]) for body in bodies),
    )


def _light(spec: mujoco.MjSpec) -> None:
    """A warm sun and blue light from the sky; no shadows, which would double the work."""
    light = spec.worldbody.add_light(name="sun", dir=_SUN, castshadow=False)
    light.type = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    light.diffuse, light.specular = [0.66, 0.63, 0.56], [0.25, 0.25, 0.25]
    light.ambient = [0.36, 0.40, 0.46]
    spec.visual.headlight.ambient = [0.06, 0.06, 0.06]
    spec.visual.headlight.diffuse = [0.10, 0.10, 0.10]
    spec.visual.headlight.specular = [0, 0, 0]


def _add_hull(
    spec: mujoco.MjSpec, vessel: Vessel, label: str, scale: float, colour: Colour
) -> Sequence[float]:
    """Attach the looks of one vessel, its hull in its colour; return its mast."""
    part = hull_part(vessel).copy()
    camera = next((c for c in part.cameras if c.name == MAST), None)
    mast = _DEFAULT_MAST if camera is None else tuple(camera.pos)
    material = part.material("hull")
    if material is not None:
        material.rgba = [*(channel / 255.0 for channel in colour), 1.0]
    body = spec.worldbody.add_frame().attach_body(part.body("hull"), f"{label}/", "")
    _freeze(spec, body, scale)
    return mast


def _freeze(spec: mujoco.MjSpec, body: mujoco.MjsBody, scale: float) -> None:
    """Keep what is seen of a body, larger by `scale`, and have it stand where it is put."""
    for part in (*body.joints, *body.sites, *body.cameras):
        spec.delete(part)
    body.mocap = True
    for geom in list(body.geoms):
        if geom.contype or geom.conaffinity:
            spec.delete(geom)
            continue
        geom.size, geom.pos = scale * geom.size, scale * geom.pos
        geom.fromto = scale * geom.fromto


def _add_items(spec: mujoco.MjSpec, classes: NDArray[np.int16], scale: float) -> None:
    """One body per item, with the look of its class."""
    part, names = shipped_part("debris"), [kind.name for kind in load_debris()]
    for k, kind in enumerate(classes.tolist()):
        body = spec.worldbody.add_frame().attach_body(part.copy().body("item"), f"item-{k}/", "")
        _freeze(spec, body, scale)
        for geom in list(body.geoms):
            if not geom.name.startswith(f"item-{k}/{names[kind]}"):
                spec.delete(geom)


def _add_harbour(spec: mujoco.MjSpec, navigable: NDArray[np.bool_], pitch_m: float) -> None:
    ground = harbour.PaddedLand.of(navigable, pitch_m)
    if ground.land.any():
        ends, _ = harbour.shoreline(ground)
        pier = harbour.piers(ground)
        lawn = harbour.inland(ground)
        yard = ground.land & ~pier & ~lawn
        boxes = sheds.shed_boxes(ground)
        if pier.any():
            _add_shape(spec, "planks", harbour.tops(ground, pier, 4.0), textures.planks())
        if yard.any():
            _add_shape(spec, "yard", harbour.tops(ground, yard, 16.0), textures.concrete(4))
        if lawn.any():
            _add_shape(spec, "lawn", harbour.tops(ground, lawn, 24.0), textures.lawn())
        if len(ends):
            _add_shape(spec, "coping", harbour.kerbs(ground, ends, 2.0), textures.coping())
            _add_shape(spec, "wall", harbour.walls(ends, 4.0), textures.wall())
            bollards = harbour.bollard_places(ends)
            if len(bollards):
                shape = harbour.posts(bollards, harbour.BOLLARD, (0.5, 0.5))
                shape.vertices[:, 2] += harbour.KERB_TOP_M
                _add_shape(spec, "bollards", shape, textures.plain((82, 88, 98)))
        if len(boxes):
            shape = sheds.shed_shape(boxes, len(textures.SHED_WALLS))
            _add_shape(spec, "sheds", shape, textures.shed_palette())
    buoys = harbour.buoy_places(navigable, pitch_m)
    if len(buoys):
        shape = harbour.posts(buoys, harbour.BUOY, (0.5, 0.5))
        _add_shape(spec, "buoys", shape, textures.plain((246, 196, 40)))


def _add_shape(
    spec: mujoco.MjSpec, name: str, shape: harbour.Shape, picture: textures.Image
) -> None:
    """A static mesh with a texture of its own."""
    texture = spec.add_texture(name=name, type=mujoco.mjtTexture.mjTEXTURE_2D)
    texture.height, texture.width, texture.nchannel = picture.shape
    texture.data = np.ascontiguousarray(picture[::-1]).tobytes()  # MuJoCo's v grows with the row
    material = spec.add_material(name=name, specular=0.05, shininess=0.1)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
    mesh = spec.add_mesh(name=name)
    mesh.uservert = shape.vertices.reshape(-1)
    mesh.userface = shape.faces.reshape(-1)
    mesh.usertexcoord = shape.uv.reshape(-1)
    mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
    spec.worldbody.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname=name,
        material=name,
        contype=0,
        conaffinity=0,
        group=1,
    )


class Stage:
    """Poses of a look, and the scenes that MuJoCo draws of it."""

    def __init__(self, look: Look, item_scale: float) -> None:
        self.look, self._item_scale = look, item_scale
        self._lift = _LIFT_M * (item_scale - 1.0)
        self._data = mujoco.MjData(look.model)
        self._scene = mujoco.MjvScene(look.model, look.model.ngeom + 64)
        self._option, self._camera = mujoco.MjvOption(), mujoco.MjvCamera()
        self._option.geomgroup[:] = (1, 1, 1, 0, 0, 0)
        for flag in (mujoco.mjtRndFlag.mjRND_SHADOW, mujoco.mjtRndFlag.mjRND_SKYBOX):
            self._scene.flags[flag] = 0
        self._plain = [look.model.mat_rgba[look.model.geom_matid[g]] for g in look.item_geoms]

    def place(self, hulls: Floats, items: Floats, known: NDArray[np.bool_]) -> None:
        """Put everything in its place.

        Parameters
        ----------
        hulls : (agent, 6) x, y, z [m], roll, pitch, yaw [rad]
        items : (item, 6) x, y, z [m], yaw [rad], tilt [rad], how much is there 0..1
        known : (item,) whether it is discovered
        """
        data, look = self._data, self.look
        for number, pose in zip(look.hulls, hulls, strict=True):
            data.mocap_pos[number] = pose[:3]
            mujoco.mju_euler2Quat(data.mocap_quat[number], pose[[5, 4, 3]], "zyx")
        for k, number in enumerate(look.items):
            x, y, z, yaw, tilt, left = items[k]
            sunk = (1.0 - left) * _SINK_M * self._item_scale
            data.mocap_pos[number] = (x, y, z + self._lift - sunk if left > 0.0 else _HIDDEN_Z)
            mujoco.mju_euler2Quat(data.mocap_quat[number], np.array([yaw, tilt, 0.0]), "zyx")
            look.model.geom_rgba[look.item_geoms[k]] = self._plain[k] * (
                (1, 1, 1, 1) if known[k] else (_DIM, _DIM, _DIM, 1.0)
            )
        mujoco.mj_kinematics(look.model, data)
        mujoco.mj_camlight(look.model, data)
        mujoco.mjv_updateScene(
            look.model,
            data,
            self._option,
            None,
            self._camera,
            mujoco.mjtCatBit.mjCAT_ALL.value,
            self._scene,
        )

    def seen(self, view: View, aspect: float, near_m: float) -> mujoco.MjvScene:
        """The scene from a view; drawn at once, as the next call changes it."""
        half = near_m * np.tan(0.5 * view.fov_rad)
        for camera in self._scene.camera:
            camera.pos, camera.forward, camera.up = view.eye, view.forward, view.up
            camera.frustum_center, camera.frustum_width = 0.0, half * aspect
            camera.frustum_bottom, camera.frustum_top = -half, half
            camera.frustum_near, camera.frustum_far = near_m, _FAR_M
        return self._scene


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
