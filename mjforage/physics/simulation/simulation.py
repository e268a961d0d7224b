"""Simulations of one scene side by side: inputs and states as live arrays, steps, checks."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel
from mjforage.base.errors import UserError
from mjforage.physics.callback import install
from mjforage.physics.callback.model_layout import (
    HEADER,
    INPUT_WIDTH,
    LOAD,
    LOSS,
    VESSEL_DOFS,
    VESSEL_INPUTS,
    VESSEL_WIDTH,
    WATER,
    WIND,
)
from mjforage.physics.floating import (
    Afloat,
    Bodies,
    Quays,
    activate,
    drift,
    quays_of,
    separate,
    sync_items,
)
from mjforage.physics.scene import Scene, parking_xy, with_bodies
from mjforage.physics.simulation.instability import (
    InstabilityError,
    check_warnings,
    warnings_suppressed,
)
from mjforage.physics.simulation.integrators import Integrator, check_lags, half_step_s, prepared

Float64Array = NDArray[np.float64]

ACTIVE_S = 0.1  # for which items are active bodies, a step at least
CLOSING_MPS = 5.0  # faster than any vessel comes to an item
MOST_BODIES = 1024  # of a scene; MuJoCo takes a minute to build it, four for twice as many
POOL_SPARE = 2  # bodies never active: the last numbers of MuJoCo's sums, added in blocks of four
STRIDE = 4  # by which pools grow: a few sizes, so that their scenes are built once
_ENGAGED = (
    *("engine", "model", "time_s", "commands", "thruster_state", "vessel_wind", "vessel_water"),
    *("load", "thrust_loss", "_pose", "_velocity", "_bodies", "_quays"),
    *("_activate", "_sync_items", "_drift", "_separate"),
)
"""Attributes that a simulation makes anew with every engine."""
_CARRIED = ("time", "qpos", "qvel", "act", "qacc_warmstart", "ctrl", "userdata")


class Simulation:
    """A batch of simulations.

    Vessels move in MuJoCo, and so do items near vessels; the others move in `physics.floating` by
    the same equations. Bodies are active from the scene's pool, which grows where it has too few.

    Attributes
    ----------
    commands : (simulation, vessel, 2) port and starboard, [rad/s] or [N] as the vessel has it
    vessel_wind, vessel_water : (simulation, vessel, 2) velocity of air and water at each vessel,
        over ground, world axes [m/s]
    load : (simulation, vessel) items aboard
    thrust_loss : (simulation, vessel, 2) share of its thrust that each thruster has lost, port and
        starboard, 0 at first
    item_wind, item_water : (simulation, item, 2) the same at each item [m/s]
    item_class : (simulation, item) index into the scene's classes; -1: not on the water
    items : items of a simulation
    time_s : (simulation,)
    engine : the `mujoco.batch.Batch` that steps them

    All of them are live: a write counts from the next step; look them up anew after a step, which
    may have brought a larger pool. At first all vessels lie at the origin, with no wind, no
    current, no load, and all items parked.
    """

    def __init__(
        self,
        scene: Scene,
        simulations: int = 1,
        *,
        integrator: Integrator = Integrator.FAST,
        step_s: float | None = None,
        threads: int = 1,
        seeds: Sequence[int | str] | None = None,
        items: int | None = None,
    ) -> None:
        """Set up simulations.

        Parameters
        ----------
        step_s : time step of the physics [s], by default the integrator's own; of the reference
            integrator at most twice the shortest lag of the vessels' thrusters
        threads : of MuJoCo; results do not depend on it
        seeds : (simulation,) names of the runs in error messages, by default their numbers; a text
            may say more, such as "3, episode 12"
        items : of each simulation, by default as many as the scene has bodies for them

        Raises
        ------
        UserError
            If the step is too long, or no callback works here.
        """
        step_s = integrator.step_s if step_s is None else step_s
        self.simulations, self.step_s, self._integrator = simulations, step_s, integrator
        if integrator is Integrator.REFERENCE:
            check_lags(scene, step_s)
        self.items = scene.items if items is None else items
        if bool(self.items) != bool(scene.items):
            scene = with_bodies(scene, self.items and POOL_SPARE + 1)
        self._threads = threads
        self._shift_s = half_step_s(integrator, step_s)
        self._every = np.arange(simulations)
        self.seeds = tuple(range(simulations) if seeds is None else seeds)
        self._take_items(Afloat.of(len(scene.classes), simulations, self.items))
        self._sizes = np.array([(0.5 * v.length_m, 0.5 * v.beam_m) for v in scene.vessels])
        self._active_steps = max(1, int(ACTIVE_S / step_s + 1e-9))  # steps
        self._engage(scene)
        self.place_items(self._parking, -1)

    def __getstate__(self) -> dict[str, Any]:
        """State for a copy, without the engine, whose memory is MuJoCo's, and its views."""
        state = {name: part for name, part in vars(self).items() if name not in _ENGAGED}
        return state | {"saved": [part.copy() for part in self._engine_parts()]}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Take the same scene, with an engine of its own."""
        saved = state.pop("saved")
        vars(self).update(state)
        self._engage(self.scene)
        for part, content in zip(self._engine_parts(), saved, strict=True):
            part[:] = content

    def _engine_parts(self) -> tuple[NDArray[Any], ...]:
        """State and warnings of the engine, and the items of active bodies, live."""
        return self.engine.state, self.engine.warning, self._bodies.item_of

    def _take_items(self, afloat: Afloat) -> None:
        """Take the items of all simulations."""
        self._afloat, self.items = afloat, afloat.kind.shape[1]
        self.item_wind, self.item_water = afloat.wind, afloat.water
        self.item_class, self._parking = afloat.kind, parking_xy(self.items)

    def _engage(self, scene: Scene) -> None:
        """Take a scene, with an engine of its own."""
        self.scene = scene
        self.model = prepared(scene, self._integrator, self.step_s)
        install()
        self.engine = Batch(self.model, self.simulations, self._threads)
        self._bind(len(scene.vessels))
        if scene.items:
            table, kinds = HEADER + len(scene.vessels) * VESSEL_WIDTH, self._afloat.kinds
            kinds.flat[:] = self.model.numeric_data[table : table + kinds.size]
            first = int(self.model.dof_bodyid[VESSEL_DOFS * len(scene.vessels)])
            self._quays = quays_of(self.model, first, scene.land, scene.pitch_m)
            self._reach = self._quays.radius_m + CLOSING_MPS * self._active_steps * self.step_s
            self._bind_items()

    def _bind_items(self) -> None:
        """Bind the kernels that move items."""
        afloat, bodies = self._afloat, self._bodies
        averaged = self._integrator is Integrator.FAST
        self._activate = BoundKernel(activate, afloat, bodies, self._pose, self._sizes, self._reach)
        self._sync_items = BoundKernel(sync_items, afloat, bodies)
        self._drift = BoundKernel(drift, afloat, self._quays, self.step_s, averaged)
        self._separate = BoundKernel(separate, afloat, self._quays, self._shift_s)

    def _bind(self, vessels: int) -> None:
        """Bind the engine's arrays: inputs, and what it steps."""
        engine, n, bodies = self.engine, self.simulations, self.scene.items
        dofs, inputs = VESSEL_DOFS * vessels, VESSEL_INPUTS * vessels
        q, v = engine.bind("qpos"), engine.bind("qvel")
        self.time_s: Float64Array = engine.bind("time")
        self._pose = q[:, :dofs].reshape(n, vessels, 3)
        self._velocity = v[:, :dofs].reshape(n, vessels, 3)
        self.commands: Float64Array = engine.bind("ctrl").reshape(n, vessels, 2)
        self.thruster_state: Float64Array = engine.bind("act").reshape(n, vessels, 2)
        data = engine.bind("userdata")
        own = data[:, :inputs].reshape(n, vessels, VESSEL_INPUTS)
        theirs = data[:, inputs:].reshape(n, bodies, INPUT_WIDTH)
        self.vessel_wind: Float64Array = own[..., WIND : WIND + 2]
        self.vessel_water: Float64Array = own[..., WATER : WATER + 2]
        self.load: Float64Array = own[..., LOAD]
        self.thrust_loss: Float64Array = own[..., LOSS : LOSS + 2]
        self._bodies = Bodies(
            q[:, dofs:].reshape(n, bodies, 2),
            v[:, dofs:].reshape(n, bodies, 2),
            theirs[..., WIND : WIND + 2],
            theirs[..., WATER : WATER + 2],
            theirs[..., LOAD],
            self.scene.parking,
            np.full((n, bodies), -1, np.int64),
            max(bodies - POOL_SPARE, 0),
        )

    def _grow(self, bodies: int) -> None:
        """Go on in a scene with bodies for so many items.

        Raises
        ------
        UserError
            If that is more than MuJoCo can build.
        """
        if bodies > MOST_BODIES:
            raise UserError(
                f"physics: {bodies} items within {self._reach:g} m of vessels, at most "
                f"{MOST_BODIES} can be; lower items.mean, or give physics.items = graph"
            )
        before = self.engine
        self._engage(with_bodies(self.scene, -(-(bodies + POOL_SPARE) // STRIDE) * STRIDE))
        for name in _CARRIED:
            old, new = before.bind(name), self.engine.bind(name)
            if old.ndim == 1:
                new[:] = old
            else:
                new[:, : old.shape[1]] = old

    def reset(self, ids: NDArray[Any] | None = None) -> None:
        """Put simulations (indices or mask, all by default) back to the start, items parked."""
        which = self._every if ids is None else self._every[ids]
        install()
        self.engine.reset(np.sort(which))
        self.item_wind[which] = self.item_water[which] = 0.0
        self._afloat.active[which], self._bodies.item_of[which] = False, -1
        self.place_items(self._parking, -1, which)

    def restart(self, ids: NDArray[np.int64], seeds: Sequence[int | str], items: int) -> None:
        """Put simulations (indices) back to the start, for other runs.

        Parameters
        ----------
        seeds : (index,) names of these runs
        items : places for them in each simulation, if more than now
        """
        named = list(self.seeds)
        for sim, seed in zip(ids, seeds, strict=True):
            named[sim] = seed
        self.seeds = tuple(named)
        if items > self.items:
            classes, before = len(self.scene.classes), self._afloat
            wide = Afloat.of(classes, self.simulations, items)
            wide.q[:] = parking_xy(items)
            for new, old in zip(wide, before, strict=True):
                new[:, : old.shape[1]] = old
            self._take_items(wide)
            self._bind_items()
        self.reset(ids)

    def place_vessels(
        self,
        pose: Float64Array,
        velocity: Float64Array | None = None,
        ids: NDArray[Any] | None = None,
    ) -> None:
        """Put vessels somewhere, at rest by default.

        Parameters
        ----------
        pose : (simulation, vessel, 3) x, y [m], yaw [rad] of midships, or what broadcasts to it
        velocity : the same, over ground in world axes [m/s], [rad/s]
        """
        which = self._every if ids is None else self._every[ids]
        self._velocity[which] = 0.0 if velocity is None else velocity
        self._pose[which] = pose + self._shift_s * self._velocity[which]

    def place_items(
        self, xy: Float64Array, classes: NDArray[Any] | int, ids: NDArray[Any] | None = None
    ) -> None:
        """Put the items of simulations on the water, at rest.

        Parameters
        ----------
        xy : (simulation, item, 2) [m], or what broadcasts to it
        classes : (simulation, item) class of each; a negative one parks the item
        """
        which = self._every if ids is None else self._every[ids]
        self.item_class[which] = classes
        self._afloat.v[which] = 0.0
        parked = self.item_class[which] < 0
        self._afloat.q[which] = np.where(parked[..., None], self._parking, xy)

    @property
    def item_kinds(self) -> tuple[Float64Array, Quays]:
        """Kinds of items (class, 3), see `Afloat`, and the quays that they meet."""
        return self._afloat.kinds, self._quays

    def remove_items(self, which: NDArray[np.bool_]) -> None:
        """Take items (simulation, item) off the water."""
        _, items = np.nonzero(which)
        self._afloat.q[which] = self._parking[items]
        self._afloat.v[which] = 0.0
        self.item_class[which] = -1.0

    def separate_items(self, ids: NDArray[np.intp]) -> None:
        """Let the items of simulations (indices) meet, with bodies or without, see `separate`."""
        self._separate(ids)

    @property
    def vessel_pose(self) -> Float64Array:
        """(simulation, vessel, 3) x, y [m], yaw [rad] of midships."""
        return np.asarray(self._pose - self._shift_s * self._velocity)

    @property
    def contact_pose(self) -> Float64Array:
        """(simulation, vessel, 3) poses at which vessels meet; a copy.

        With the fast integrator they run half a step ahead of `vessel_pose`: a hull that the coming
        half step takes to a quay has lost its way already.
        """
        return np.array(self._pose)

    @property
    def vessel_velocity(self) -> Float64Array:
        """(simulation, vessel, 3) over ground, world axes [m/s], yaw rate [rad/s]; a copy."""
        return np.array(self._velocity)

    @property
    def item_xy(self) -> Float64Array:
        """(simulation, item, 2) [m]."""
        return np.asarray(self._afloat.q - self._shift_s * self._afloat.v)

    @property
    def item_velocity(self) -> Float64Array:
        """(simulation, item, 2) over ground [m/s]; a copy."""
        return np.array(self._afloat.v)

    def snapshot(self) -> Float64Array:
        """(simulation, number) all that a run goes on from: MuJoCo's states and the items."""
        parts = (self.engine.state, *self._afloat[:5])
        return np.concatenate([part.reshape(self.simulations, -1) for part in parts], axis=1)

    def restore(self, saved: Float64Array, ids: NDArray[Any] | None = None) -> None:
        """Put simulations (indices or mask, all by default) back to a snapshot of as many.

        It must be of the same scene, from before its pool of bodies grew.
        """
        which = self._every if ids is None else self._every[ids]
        parts = (self.engine.state, *self._afloat[:5])
        edges = np.cumsum([part[0].size for part in parts])[:-1]
        for part, piece in zip(parts, np.split(saved, edges, axis=1), strict=True):
            part[which] = piece.reshape(len(which), *part.shape[1:])

    def step(self, steps: int = 1, ids: NDArray[Any] | None = None) -> None:
        """Advance simulations (indices or mask, all by default) by `steps` time steps.

        Raises
        ------
        InstabilityError
            If one of them became unstable, naming its seed, the time and the body.
        UserError
            If more items are near vessels than there can be bodies.
        """
        which = self._every if ids is None else self._every[ids]
        before = self.time_s.copy()
        install()
        with warnings_suppressed():
            if self.items:
                for done in range(0, steps, self._active_steps):
                    self._step_items(which, min(self._active_steps, steps - done))
            else:
                self.engine.step(None if ids is None else which, nstep=steps)
        check_warnings(self.model, self.engine.warning, which, self.seeds, before)

    def _step_items(self, ids: NDArray[np.intp], steps: int) -> None:
        """Advance vessels and items by at most `_active_steps` steps.

        Raises
        ------
        InstabilityError
            If an item became unstable.
        """
        wanted = self._activate(ids)
        if wanted > self._bodies.most:
            self._grow(wanted)
            self._activate(ids)
        self.engine.step(ids if len(ids) < self.simulations else None, nstep=steps)
        self._sync_items(ids)
        sim, item = self._drift(ids, steps)
        if item >= 0:
            raise InstabilityError(
                f"physics: unstable at seed {self.seeds[sim]}, t = {self.time_s[sim]:.2f} s, item "
                f"{item}; check the wind and the water given to it"
            )
