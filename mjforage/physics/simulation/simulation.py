"""Simulations of one scene side by side: inputs and states as live arrays, steps, checks."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from mjforage.core.errors import UserError
from mjforage.physics.callback import Route, calling, install
from mjforage.physics.callback.model_layout import INPUT_WIDTH, LOAD, VESSEL_DOFS, WATER, WIND
from mjforage.physics.scene import Scene
from mjforage.physics.simulation.instability import check_warnings
from mjforage.physics.simulation.integrators import Integrator, half_step_s, prepared
from mjforage.physics.simulation.loop import Loop
from mjforage.physics.simulation.quiet import silent

Float64Array = NDArray[np.float64]


class Simulation:
    """A batch of simulations.

    Attributes
    ----------
    commands : (simulation, vessel, 2) port and starboard, [rad/s] or [N] as the vessel has it
    vessel_wind, vessel_water : (simulation, vessel, 2) velocity of air and water at each vessel,
        over ground, world axes [m/s]
    load : (simulation, vessel) items aboard
    item_wind, item_water : (simulation, item, 2) the same at each item [m/s]
    item_class : (simulation, item) index into the scene's classes; -1: not on the water
    time_s : (simulation,)
    engine : what steps them, `mujoco.batch.Batch` on the native route

    All of them are live: a write counts from the next step. At first all vessels lie at the
    origin, with no wind, no current, no load, and all items parked.
    """

    def __init__(
        self,
        scene: Scene,
        simulations: int = 1,
        *,
        integrator: Integrator = Integrator.FAST,
        step_s: float = 0.1,
        threads: int = 1,
        seeds: Sequence[int | str] | None = None,
    ) -> None:
        """Set up simulations.

        Parameters
        ----------
        step_s : time step of the physics [s]; of the reference integrator at most twice the
            shortest lag of the vessels' thrusters
        threads : of MuJoCo; results do not depend on it
        seeds : (simulation,) names of the runs in error messages, by default their numbers; a text
            may say more, such as "3, episode 12"

        Raises
        ------
        UserError
            If a number is out of range, or no callback works here.
        """
        if simulations < 1 or threads < 1 or not 0.0 < step_s < np.inf:
            raise UserError(
                f"simulation: {simulations} simulations, {threads} threads, step {step_s} s; "
                "give numbers above 0"
            )
        self.scene, self.simulations, self.step_s = scene, simulations, step_s
        if integrator is Integrator.REFERENCE:
            _check_lags(scene, step_s)
        self.route = install()
        self.model = prepared(scene.model, integrator, step_s)
        self.engine: Any = (
            Batch(self.model, simulations, threads)
            if self.route is Route.NATIVE
            else Loop(self.model, simulations)
        )
        self._shift_s = half_step_s(integrator, step_s)
        self._every = np.arange(simulations)
        self.seeds = tuple(range(simulations) if seeds is None else seeds)
        if len(self.seeds) != simulations:
            raise UserError(f"simulation: {len(self.seeds)} seeds, expected {simulations}")
        self._bind(len(scene.vessels))
        self.place_items(scene.parking, -1)

    def _bind(self, vessels: int) -> None:
        engine, n, items = self.engine, self.simulations, self.scene.items
        dofs, inputs = VESSEL_DOFS * vessels, INPUT_WIDTH * vessels
        self._qpos, self._qvel = engine.bind("qpos"), engine.bind("qvel")
        self.time_s: Float64Array = engine.bind("time")
        self._pose = self._qpos[:, :dofs].reshape(n, vessels, 3)
        self._velocity = self._qvel[:, :dofs].reshape(n, vessels, 3)
        self._item_xy = self._qpos[:, dofs:].reshape(n, items, 2)
        self._item_velocity = self._qvel[:, dofs:].reshape(n, items, 2)
        self.commands: Float64Array = engine.bind("ctrl").reshape(n, vessels, 2)
        self.thruster_state: Float64Array = engine.bind("act").reshape(n, vessels, 2)
        data = engine.bind("userdata")
        own = data[:, :inputs].reshape(n, vessels, INPUT_WIDTH)
        theirs = data[:, inputs:].reshape(n, items, INPUT_WIDTH)
        self.vessel_wind: Float64Array = own[..., WIND : WIND + 2]
        self.vessel_water: Float64Array = own[..., WATER : WATER + 2]
        self.load: Float64Array = own[..., LOAD]
        self.item_wind: Float64Array = theirs[..., WIND : WIND + 2]
        self.item_water: Float64Array = theirs[..., WATER : WATER + 2]
        self.item_class: Float64Array = theirs[..., LOAD]

    def reset(self, ids: NDArray[Any] | None = None) -> None:
        """Put simulations (indices or mask, all by default) back to the start, items parked."""
        chosen = self._every if ids is None else self._every[ids]
        with calling():
            self.engine.reset(chosen)
        self.place_items(self.scene.parking, -1, chosen)

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
        chosen = self._every if ids is None else self._every[ids]
        self._velocity[chosen] = 0.0 if velocity is None else velocity
        self._pose[chosen] = pose + self._shift_s * self._velocity[chosen]

    def place_items(
        self, xy: Float64Array, classes: NDArray[Any] | int, ids: NDArray[Any] | None = None
    ) -> None:
        """Put the items of simulations on the water, at rest.

        Parameters
        ----------
        xy : (simulation, item, 2) [m], or what broadcasts to it
        classes : (simulation, item) class of each; a negative one parks the item

        Raises
        ------
        UserError
            If there is no such class.
        """
        chosen = self._every if ids is None else self._every[ids]
        if np.max(classes, initial=-1) >= len(self.scene.classes):
            raise UserError(
                f"debris class {np.max(classes)}: the scene has {len(self.scene.classes)}, "
                "counted from 0"
            )
        self.item_class[chosen] = classes
        self._item_velocity[chosen] = 0.0
        parked = self.item_class[chosen] < 0
        self._item_xy[chosen] = np.where(parked[..., None], self.scene.parking, xy)

    def remove_items(self, which: NDArray[np.bool_]) -> None:
        """Take items (simulation, item) off the water."""
        _, items = np.nonzero(which)
        self._item_xy[which] = self.scene.parking[items]
        self._item_velocity[which] = 0.0
        self.item_class[which] = -1.0

    @property
    def vessel_pose(self) -> Float64Array:
        """(simulation, vessel, 3) x, y [m], yaw [rad] of midships."""
        return np.asarray(self._pose - self._shift_s * self._velocity)

    @property
    def vessel_velocity(self) -> Float64Array:
        """(simulation, vessel, 3) over ground, world axes [m/s], yaw rate [rad/s]; a copy."""
        return np.array(self._velocity)

    @property
    def item_xy(self) -> Float64Array:
        """(simulation, item, 2) [m]."""
        return np.asarray(self._item_xy - self._shift_s * self._item_velocity)

    @property
    def item_velocity(self) -> Float64Array:
        """(simulation, item, 2) over ground [m/s]; a copy."""
        return np.array(self._item_velocity)

    @property
    def state(self) -> Float64Array:
        """(simulation, number) MuJoCo's integration states, live: a copy of it resumes a run."""
        state: Float64Array = self.engine.state
        return state

    def step(self, steps: int = 1, ids: NDArray[Any] | None = None) -> None:
        """Advance simulations (indices or mask, all by default) by `steps` time steps.

        Raises
        ------
        InstabilityError
            If one of them became unstable, naming its seed, the time and the body.
        """
        chosen = self._every if ids is None else self._every[ids]
        before = self.time_s.copy()
        with calling(), silent():
            self.engine.step(None if ids is None else chosen, nstep=steps)
        check_warnings(self.model, self.engine.warning, chosen, self.seeds, before)


def _check_lags(scene: Scene, step_s: float) -> None:
    """Refuse steps on which Runge-Kutta of order 4 would make a lag oscillate without a warning.

    It is unstable from 2.785 time constants on, and the command's range hides it. The fast
    integrator solves the lag exactly.
    """
    lag_s, name = min((v.lag_s, n) for v, n in zip(scene.vessels, scene.names, strict=True))
    if step_s > 2.0 * lag_s:
        raise UserError(
            f"simulation: step {step_s:g} s of the reference integrator is too long for "
            f"lag_s = {lag_s:g} s of {name}; give a step of at most {2.0 * lag_s:g} s or take the "
            "fast integrator"
        )
