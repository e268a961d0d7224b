"""Vessels and items of simulations side by side: what every engine that moves them has."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, NoReturn

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel
from mjforage.physics.callback.model_layout import (
    HEADER,
    LOAD,
    LOSS,
    SPREAD,
    VESSEL_DOFS,
    VESSEL_WIDTH,
    WATER,
    WIND,
)
from mjforage.physics.floating import Afloat, Quays, drift, quays_of, separate
from mjforage.physics.floating.item_contacts import Scratch
from mjforage.physics.scene import Scene, parking_xy
from mjforage.physics.simulation.instability import InstabilityError

Float64Array = NDArray[np.float64]

ACTIVE_S = 0.1  # for which items are near vessels or not, a step at least
CLOSING_MPS = 5.0  # faster than any vessel comes to an item


class SimulatedFleet(ABC):
    """A batch of simulations.

    Attributes
    ----------
    commands : (simulation, vessel, 2) port and starboard, [rad/s] or [N] as the vessel has it
    vessel_wind, vessel_water : (simulation, vessel, 2) velocity of air and water at each vessel,
        over ground, world axes [m/s]
    load : (simulation, vessel) items aboard
    thrust_loss : (simulation, vessel, 2) share of its thrust that each thruster has lost, port and
        starboard, 0 at first
    spread : (simulation, vessel, 3) by how much mass, drag and thrust exceed the scene's, as shares
        of it, 0 at first
    item_wind, item_water : (simulation, item, 2) the same at each item [m/s]
    item_class : (simulation, item) index into the scene's classes; -1: not on the water
    items : items of a simulation
    time_s : (simulation,)

    All of them are live: a write counts from the next step; look them up anew after a step. At
    first all vessels lie at the origin, with no wind, no current, no load, and all items parked.
    """

    scene: Scene
    time_s: Float64Array
    commands: Float64Array
    thruster_state: Float64Array
    _pose: Float64Array  # (simulation, vessel, 3) as MuJoCo has it, see `integrators`
    _velocity: Float64Array

    def _begin(
        self,
        scene: Scene,
        simulations: int,
        step_s: float,
        shift_s: float,
        seeds: Sequence[int | str] | None,
        items: int,
    ) -> None:
        """Take what does not hang on the engine.

        `shift_s`: time by which positions run ahead of velocities.
        """
        self.simulations, self.step_s, self._shift_s = simulations, step_s, shift_s
        self._every = np.arange(simulations)
        self.seeds = tuple(range(simulations) if seeds is None else seeds)
        self._take_items(Afloat.of(len(scene.classes), simulations, items))
        self._sizes = np.array([(0.5 * v.length_m, 0.5 * v.beam_m) for v in scene.vessels])
        self._active_steps = max(1, int(ACTIVE_S / step_s + 1e-9))  # steps

    def _take_items(self, afloat: Afloat) -> None:
        """Take the items of all simulations."""
        self._afloat, self.items = afloat, afloat.kind.shape[1]
        self.item_wind, self.item_water = afloat.wind, afloat.water
        self.item_class, self._parking = afloat.kind, parking_xy(self.items)

    def _take_inputs(self, own: Float64Array) -> None:
        """Take the inputs of vessels (simulation, vessel, `VESSEL_INPUTS`), see `model_layout`."""
        self.vessel_wind: Float64Array = own[..., WIND : WIND + 2]
        self.vessel_water: Float64Array = own[..., WATER : WATER + 2]
        self.load: Float64Array = own[..., LOAD]
        self.thrust_loss: Float64Array = own[..., LOSS : LOSS + 2]
        self.spread: Float64Array = own[..., SPREAD : SPREAD + 3]

    def _take_quays(self, model: mujoco.MjModel) -> None:
        """Take classes of items and their contacts from a model with bodies for some of them."""
        vessels, kinds = len(self.scene.vessels), self._afloat.kinds
        table = HEADER + vessels * VESSEL_WIDTH
        kinds.flat[:] = model.numeric_data[table : table + kinds.size]
        first = int(model.dof_bodyid[VESSEL_DOFS * vessels])
        self._quays = quays_of(model, first, self.scene.land, self.scene.pitch_m)
        self._reach = self._quays.radius_m + CLOSING_MPS * self._active_steps * self.step_s
        self._bind_items()

    def _bind_items(self) -> None:
        """Bind the kernels that move items."""
        averaged = self._shift_s > 0.0
        self._drift = BoundKernel(drift, self._afloat, self._quays, self.step_s, averaged)
        contacts = self._afloat, self._quays, self._shift_s, Scratch.of(self.items)
        self._separate = BoundKernel(separate, *contacts)

    @abstractmethod
    def reset(self, ids: NDArray[Any] | None = None) -> None:
        """Put simulations (indices or mask, all by default) back to the start, items parked."""

    @abstractmethod
    def step(self, steps: int = 1, ids: NDArray[Any] | None = None) -> None:
        """Advance simulations (indices or mask, all by default) by `steps` time steps."""

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

    def _drift_items(self, ids: NDArray[np.intp], steps: int) -> None:
        """Let the items of simulations (indices) drift; raises `InstabilityError`."""
        sim, item = self._drift(ids, steps)
        if item >= 0:
            self._refuse(sim, f"item {item}", "the wind and the water given to it")

    def _refuse(self, sim: int, what: str, cause: str) -> NoReturn:
        raise InstabilityError(
            f"physics: unstable at seed {self.seeds[sim]}, t = {self.time_s[sim]:.2f} s, {what}; "
            f"check {cause}"
        )

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
