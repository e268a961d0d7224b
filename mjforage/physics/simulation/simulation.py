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
    INPUT_WIDTH,
    LOAD,
    VESSEL_DOFS,
    VESSEL_INPUTS,
    WATER,
    WIND,
)
from mjforage.physics.floating import (
    Bodies,
    activate,
    sync_items,
)
from mjforage.physics.scene import Scene, with_bodies
from mjforage.physics.simulation.instability import (
    check_warnings,
    warnings_suppressed,
)
from mjforage.physics.simulation.integrators import Integrator, check_lags, half_step_s, prepared
from mjforage.physics.simulation.simulated_fleet import SimulatedFleet

Float64Array = NDArray[np.float64]

MOST_BODIES = 1024  # of a scene; MuJoCo takes a minute to build it, four for twice as many
POOL_SPARE = 2  # bodies never active: the last numbers of MuJoCo's sums, added in blocks of four
STRIDE = 4  # by which pools grow: a few sizes, so that their scenes are built once
_ENGAGED = (
    *("engine", "model", "time_s", "commands", "thruster_state", "vessel_wind", "vessel_water"),
    *("load", "thrust_loss", "spread", "_pose", "_velocity", "_bodies", "_quays"),
    *("_activate", "_sync_items", "_drift", "_separate"),
)
"""Attributes that a simulation makes anew with every engine."""
_CARRIED = ("time", "qpos", "qvel", "act", "qacc_warmstart", "ctrl", "userdata")


class Simulation(SimulatedFleet):
    """A batch of simulations in MuJoCo.

    Vessels move in MuJoCo, and so do items near vessels; the others move in `physics.floating` by
    the same equations. Bodies are active from the scene's pool, which grows where it has too few.

    Attributes
    ----------
    engine : the `mujoco.batch.Batch` that steps them

    A step may bring a larger pool, with which all attributes are other arrays.
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

        Raises `UserError` if the step is too long, or no callback works here.

        Parameters
        ----------
        step_s : time step of the physics [s], by default the integrator's own; of the reference
            integrator at most twice the shortest lag of the vessels' thrusters
        threads : of MuJoCo; results do not depend on it
        seeds : (simulation,) names of the runs in error messages, by default their numbers; a text
            may say more, such as "3, episode 12"
        items : of each simulation, by default as many as the scene has bodies for them
        """
        step_s = integrator.step_s if step_s is None else step_s
        self._integrator, self._threads = integrator, threads
        if integrator is Integrator.REFERENCE:
            check_lags(scene, step_s)
        items = scene.items if items is None else items
        if bool(items) != bool(scene.items):
            scene = with_bodies(scene, items and POOL_SPARE + 1)
        self._begin(scene, simulations, step_s, half_step_s(integrator, step_s), seeds, items)
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

    def _engage(self, scene: Scene) -> None:
        """Take a scene, with an engine of its own."""
        self.scene = scene
        self.model = prepared(scene, self._integrator, self.step_s)
        install()
        self.engine = Batch(self.model, self.simulations, self._threads)
        self._bind(len(scene.vessels))
        if scene.items:
            self._take_quays(self.model)

    def _bind_items(self) -> None:
        super()._bind_items()
        afloat, bodies = self._afloat, self._bodies
        self._activate = BoundKernel(activate, afloat, bodies, self._pose, self._sizes, self._reach)
        self._sync_items = BoundKernel(sync_items, afloat, bodies)

    def _bind(self, vessels: int) -> None:
        """Bind the engine's arrays: inputs, and what it steps."""
        engine, n, bodies = self.engine, self.simulations, self.scene.items
        dofs, inputs = VESSEL_DOFS * vessels, VESSEL_INPUTS * vessels
        q, v = engine.bind("qpos"), engine.bind("qvel")
        self.time_s = engine.bind("time")
        self._pose = q[:, :dofs].reshape(n, vessels, 3)
        self._velocity = v[:, :dofs].reshape(n, vessels, 3)
        self.commands = engine.bind("ctrl").reshape(n, vessels, 2)
        self.thruster_state = engine.bind("act").reshape(n, vessels, 2)
        data = engine.bind("userdata")
        own = data[:, :inputs].reshape(n, vessels, VESSEL_INPUTS)
        theirs = data[:, inputs:].reshape(n, bodies, INPUT_WIDTH)
        self._take_inputs(own)
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

        Raises `UserError` if that is more than MuJoCo can build.
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

        Raises `InstabilityError` if one of them became unstable, naming its seed, the time and the
        body; `UserError` if more items are near vessels than there can be bodies.
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

        Raises `InstabilityError` if an item became unstable.
        """
        wanted = self._activate(ids)
        if wanted > self._bodies.most:
            self._grow(wanted)
            self._activate(ids)
        self.engine.step(ids if len(ids) < self.simulations else None, nstep=steps)
        self._sync_items(ids)
        self._drift_items(ids, steps)
