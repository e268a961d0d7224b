"""Simulations whose hulls move in MuJoCo Warp and whose items in our kernels, all on one device.

All that controls, senses and collects is that of `simulation.Simulation`, and the bits of a
simulation do not depend on those beside it. Items are points for hulls (`floating.beside_hulls`).
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Call, Launch
from mjforage.physics.callback.model_layout import VESSEL_DOFS
from mjforage.physics.device_hulls import DeviceHulls, Live
from mjforage.physics.floating.beside_hulls import DRIFT_BESIDE, Hulls
from mjforage.physics.floating.drift import DRIFT, Afloat
from mjforage.physics.floating.item_contacts import SEPARATE, Scratch
from mjforage.physics.hydrodynamics.parameters import pack_fleet
from mjforage.physics.scene import Scene, with_bodies
from mjforage.physics.simulation.integrators import Integrator, half_step_s, prepared
from mjforage.physics.simulation.simulated_fleet import SimulatedFleet

Float64Array = NDArray[np.float64]


class Inputs(NamedTuple):
    """Inputs of the vessels, (simulation, vessel, ...) as of `SimulatedFleet`."""

    commands: Float64Array
    wind: Float64Array
    water: Float64Array
    load: Float64Array
    loss: Float64Array
    spread: Float64Array


class State(NamedTuple):
    """The vessels, (simulation, vessel, ...), poses as MuJoCo has them."""

    pose: Float64Array
    velocity: Float64Array
    lagged: Float64Array  # commands, by the thrusters' lag [rad/s] or [N]
    there: Float64Array  # pose and velocity before the last step
    before: Float64Array
    heavier: Float64Array  # (simulation, vessel) by what share of its mass
    time_s: Float64Array  # (simulation,)
    unstable: NDArray[np.bool_]  # (simulation, vessel) whether it had no place after a step
    lost: NDArray[np.int64]  # (simulation,) 1 more than the number of an item without a place; 0


@kernel
def _give(inputs: Inputs, state: State, live: Live) -> None:
    """Write inputs and state for Warp."""
    for e in range(state.pose.shape[0]):
        for i in range(state.pose.shape[1]):
            for axis in range(3):
                at, rate = state.pose[e, i, axis], state.velocity[e, i, axis]
                state.there[e, i, axis], state.before[e, i, axis] = at, rate
                live.places[e, 3 * i + axis], live.velocities[e, 3 * i + axis] = at, rate
            spread, around = inputs.spread[e, i], live.around[e, i]
            state.heavier[e, i] = spread[0]
            for k in range(2):
                live.lagged[e, 2 * i + k] = state.lagged[e, i, k]
                live.commands[e, 2 * i + k] = inputs.commands[e, i, k]
                around[k], around[2 + k] = inputs.wind[e, i, k], inputs.water[e, i, k]
                around[5 + k] = (1.0 - inputs.loss[e, i, k]) * (1.0 + spread[2])  # what is left
            around[4], around[7], around[8] = inputs.load[e, i], 1.0 + spread[0], 1.0 + spread[1]


@kernel
def _take(live: Live, step_s: float, state: State, ids: NDArray[np.int64]) -> None:
    """Read the state of simulations `ids` after a step. A vessel without a place stays."""
    for e in ids:
        later = step_s
        for i in range(state.pose.shape[1]):
            whole = 0.0
            for axis in range(3):
                whole += live.places[e, 3 * i + axis] + live.velocities[e, 3 * i + axis]
            if not math.isfinite(whole):
                state.unstable[e, i], later = True, 0.0
                continue
            for axis in range(3):
                state.pose[e, i, axis] = live.places[e, 3 * i + axis]
                state.velocity[e, i, axis] = live.velocities[e, 3 * i + axis]
            for k in range(2):
                state.lagged[e, i, k] = live.lagged[e, 2 * i + k]
        state.time_s[e] += later


@kernel
def _lose_items(
    active: NDArray[np.bool_], q: Float64Array, kind: Float64Array, lost: NDArray[np.int64]
) -> None:
    """Note an item on the water that has no place, in each of the active simulations."""
    for e in range(active.size):
        for k in range(kind.shape[1]):
            if active[e] and kind[e, k] >= 0.0 and not math.isfinite(q[e, k, 0] + q[e, k, 1]):
                lost[e] = k + 1


GIVE, TAKE, LOSE_ITEMS = Launch(_give), Launch(_take), Launch(_lose_items)


class WarpSimulation(SimulatedFleet):
    """A batch of simulations with hulls in Warp, by the fast integrator.

    Attributes
    ----------
    hulls : the vessels on the device, and what arrays of the host are there
    """

    def __init__(
        self,
        scene: Scene,
        simulations: int = 1,
        *,
        device: str = "warp-cpu",
        step_s: float = 0.1,
        seeds: Sequence[int | str] | None = None,
        items: int = 0,
    ) -> None:
        """Set up simulations.

        Raises `UserError` if there is no such device.

        `device`: "warp-cpu" or "cuda"; `seeds`, `items`: as of `Simulation`.
        """
        self.scene, vessels = scene, len(scene.vessels)
        shift_s = half_step_s(Integrator.FAST, step_s)
        self._begin(scene, simulations, step_s, shift_s, seeds, items)
        bare = with_bodies(scene, 0)
        self.hulls = DeviceHulls(bare, simulations, step_s=step_s, device=device)
        every, pairs = (simulations, vessels, VESSEL_DOFS), (simulations, vessels, 2)
        self.time_s = np.zeros(simulations)
        self.commands, self.thruster_state, self.thrust_loss = np.zeros((3, *pairs))
        self.vessel_wind, self.vessel_water = np.zeros((2, *pairs))
        self.load, heavier = np.zeros((2, simulations, vessels))
        self.spread, self._pose, self._velocity, there, before = np.zeros((5, *every))
        self._inputs = Inputs(
            self.commands,
            self.vessel_wind,
            self.vessel_water,
            self.load,
            self.thrust_loss,
            self.spread,
        )
        self._state = State(
            self._pose,
            self._velocity,
            self.thruster_state,
            there,
            before,
            heavier,
            self.time_s,
            np.zeros(every[:2], np.bool_),
            np.zeros(simulations, np.int64),
        )
        self._ids = np.zeros(simulations, np.bool_)
        if items:
            self._take_quays(prepared(with_bodies(scene, 1), Integrator.FAST, step_s))
        self.place_items(self._parking, -1)

    def calls(self, active: NDArray[np.bool_]) -> tuple[Call, ...]:
        """A step of the simulations that an array (simulation,) then has."""
        hulls, step_s, state = self.hulls, self.step_s, self._state
        step = [
            hulls.bind(GIVE, self._inputs, state, hulls.live),
            hulls.step,
            hulls.bind(TAKE, hulls.live, step_s, state, active),
        ]
        if self.items:
            packed, loads = pack_fleet(self.scene.vessels), (self.load, state.heavier)
            ways = state.there, state.before, state.velocity, state.pose
            about = self._afloat, self._quays, Hulls(packed, *loads, self._sizes, *ways)
            memory = np.zeros((2, *self._sizes.shape[:1], VESSEL_DOFS))
            beside = hulls.bind(DRIFT_BESIDE, *about, self._reach, step_s, memory, active)
            drift = hulls.bind(DRIFT, self._afloat, self._quays, step_s, True, active, 1)
            step += [beside, drift]
        return tuple(step)

    def separating(self, active: NDArray[np.bool_]) -> Call:
        """`separate_items` of the simulations that an array (simulation,) then has."""
        about = self._afloat, self._quays, self._shift_s, Scratch.of(self.items)
        return self.hulls.bind(SEPARATE, *about, active)

    @property
    def afloat(self) -> Afloat:
        """The items, live."""
        return self._afloat

    @property
    def velocity(self) -> Float64Array:
        """(simulation, vessel, 3) over ground, world axes [m/s], [rad/s]; live."""
        return self._velocity

    @property
    def shift_s(self) -> float:
        """Time by which places run ahead of velocities [s]."""
        return self._shift_s

    @property
    def contact_state(self) -> tuple[Float64Array, Float64Array]:
        """Poses (simulation, vessel, 3) at which vessels meet, and lagged commands; live."""
        return self._pose, self.thruster_state

    @property
    def arrays(self) -> tuple[NDArray[Any], ...]:
        """All that `calls` writes, and what of the items the host may write."""
        afloat = self._afloat
        return (*self._state, afloat.q, afloat.v, afloat.kind, afloat.active)

    def reset(self, ids: NDArray[Any] | None = None) -> None:
        """Put simulations (indices or mask, all by default) back to the start, items parked."""
        which = self._every if ids is None else self._every[ids]
        for part in (*self._state, *self._inputs, self.item_wind, self.item_water):
            part[which] = 0
        self.place_items(self._parking, -1, which)

    def step(self, steps: int = 1, ids: NDArray[Any] | None = None) -> None:
        """Advance simulations (indices or mask, all by default) by `steps` time steps.

        Raises `InstabilityError` if one of them became unstable, naming its seed, the time and the
        body; `UserError` if hulls have more contacts than there is room for.
        """
        self._ids[:] = False
        self._ids[self._every if ids is None else ids] = True
        self.hulls.renew()
        step = *self.calls(self._ids), self.losing(self._ids)
        for _ in range(steps):
            self.hulls.run(step)
            self.hulls.wait()
            self.fetch()
            self.check()

    def fetch(self) -> None:
        """Have the host know of what the device has written."""
        for array in self.arrays:
            self.hulls.arrays.fetch(array)

    def losing(self, active: NDArray[np.bool_]) -> Call:
        """Note items without a place, in the simulations that an array (simulation,) then has."""
        afloat = self._afloat
        return self.hulls.bind(LOSE_ITEMS, active, afloat.q, afloat.kind, self._state.lost)

    @property
    def faults(self) -> list[NDArray[Any]]:
        """Notes that something has no place, live."""
        return [self._state.unstable, self._state.lost]

    def check(self) -> None:
        """Refuse simulations in which something was noted to have no place, as the host knows it.

        Raises `InstabilityError`.
        """
        if self._state.unstable.any():
            sim, vessel = np.argwhere(self._state.unstable)[0]
            what = f"body {self.scene.names[vessel]}"
            self._refuse(int(sim), what, "the vessel's parameters and commands")
        if self._state.lost.any():
            sim = int(np.flatnonzero(self._state.lost)[0])
            item = int(self._state.lost[sim]) - 1
            self._refuse(sim, f"item {item}", "the wind and the water given to it")
