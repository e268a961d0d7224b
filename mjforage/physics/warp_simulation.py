"""Simulations whose hulls move in MuJoCo Warp, on a GPU or a CPU; the rest is on this machine.

State and inputs stand here and go there and back in each step, so that all that controls, senses
and collects is that of `simulation.Simulation`, and the bits of a simulation do not depend on those
beside it. Items are points for hulls (`floating.beside_hulls`).
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel
from mjforage.physics.callback.model_layout import LOSS, SPREAD, VESSEL_DOFS, VESSEL_INPUTS
from mjforage.physics.floating.beside_hulls import Hulls, drift_beside
from mjforage.physics.hydrodynamics.parameters import pack_fleet
from mjforage.physics.scene import Scene, with_bodies
from mjforage.physics.simulation.integrators import Integrator, half_step_s, prepared
from mjforage.physics.simulation.simulated_fleet import SimulatedFleet
from mjforage.physics.warp_hulls import WarpHulls


class WarpSimulation(SimulatedFleet):
    """A batch of simulations with hulls in Warp, by the fast integrator."""

    def __init__(
        self,
        scene: Scene,
        simulations: int = 1,
        *,
        device: str = "cpu",
        step_s: float = 0.1,
        seeds: Sequence[int | str] | None = None,
        items: int = 0,
    ) -> None:
        """Set up simulations.

        Raises `UserError` if there is no such device.

        `device`: "cpu" or "cuda", as Warp names it; `seeds`, `items`: as of `Simulation`.
        """
        self.scene, vessels = scene, len(scene.vessels)
        shift_s = half_step_s(Integrator.FAST, step_s)
        self._begin(scene, simulations, step_s, shift_s, seeds, items)
        self._hulls = WarpHulls(with_bodies(scene, 0), simulations, step_s=step_s, device=device)
        self.time_s = np.zeros(simulations)
        self.commands, self.thruster_state = np.zeros((2, simulations, vessels, 2))
        self._pose, self._velocity, self._before = np.zeros((3, simulations, vessels, VESSEL_DOFS))
        self._there = np.zeros_like(self._pose)
        self._inputs = np.zeros((simulations, vessels, VESSEL_INPUTS))
        self._take_inputs(self._inputs)
        if items:
            self._take_quays(prepared(with_bodies(scene, 1), Integrator.FAST, step_s))
        self.place_items(self._parking, -1)

    def _bind_items(self) -> None:
        super()._bind_items()
        packed, where = pack_fleet(self.scene.vessels), (self._there, self._before)
        loads = self.load, self.spread[..., 0]
        hulls = Hulls(packed, *loads, self._sizes, *where, self._velocity, self._pose)
        about = self._afloat, self._quays, hulls, self._reach, self.step_s
        self._drift_beside = BoundKernel(drift_beside, *about)

    def reset(self, ids: NDArray[Any] | None = None) -> None:
        """Put simulations (indices or mask, all by default) back to the start, items parked."""
        which = self._every if ids is None else self._every[ids]
        state = self.time_s, self.commands, self.thruster_state, self._pose, self._velocity
        for part in (*state, self._inputs, self.item_wind, self.item_water):
            part[which] = 0.0
        self.place_items(self._parking, -1, which)

    def step(self, steps: int = 1, ids: NDArray[Any] | None = None) -> None:
        """Advance simulations (indices or mask, all by default) by `steps` time steps.

        Raises `InstabilityError` if one of them became unstable, naming its seed, the time and the
        body; `UserError` if hulls have more contacts than there is room for.
        """
        which = self._every if ids is None else self._every[ids]
        for _ in range(steps):
            self._there[:], self._before[:] = self._pose, self._velocity
            self._step_hulls(which)
            if self.items:
                self._drift_beside(which)
                self._drift_items(which, 1)

    def _step_hulls(self, ids: NDArray[np.intp]) -> None:
        """One step of the hulls; what becomes of the other simulations is not taken."""
        factors, given = 1.0 + self.spread, self._inputs[..., : SPREAD + 2].copy()
        given[..., LOSS : LOSS + 2] = (1.0 - self.thrust_loss) * factors[..., 2:]  # what is left
        given[..., SPREAD:] = factors[..., :2]
        hulls = self._hulls
        hulls.put(self._pose, self._velocity, self.thruster_state, self.commands, given)
        hulls.step()
        state = self._pose, self._velocity, self.thruster_state
        for own, new in zip(state, hulls.state(), strict=True):
            own[ids] = new[ids]
        self.time_s[ids] += self.step_s
        bad = ~np.isfinite(self._pose[ids] + self._velocity[ids]).all(axis=2)
        if bad.any():
            sim, vessel = np.argwhere(bad)[0]
            what = f"body {self.scene.names[vessel]}"
            self._refuse(int(ids[sim]), what, "the vessel's parameters and commands")
