"""The two integrators: fast for training, reference for validation.

Both advance a vessel by its own equation of motion between contacts. The fast one is semi-implicit
Euler, q' then q, with the mean acceleration that one Runge-Kutta step of the vessel predicts. That
is a leapfrog: its positions belong to half a step after its velocities. The callback allows for it,
and `half_step_s` lets readings undo it, which makes the pair of second order.
"""

from enum import Enum

import mujoco

from mjforage.base.errors import UserError
from mjforage.physics.callback.model_layout import AVERAGED, INSTANT, SCHEME
from mjforage.physics.scene import Scene
from mjforage.physics.simulation.fenders import set_fenders


class Integrator(Enum):
    """The two ways to step a simulation."""

    FAST = "fast"
    """Euler with forces averaged over the step."""
    REFERENCE = "reference"
    """Classical Runge-Kutta, order 4."""

    @property
    def step_s(self) -> float:
        """Step that it takes by default [s]: at 0.1 s Runge-Kutta is the less exact of the two."""
        return 0.1 if self is Integrator.FAST else 0.02


def prepared(scene: Scene, integrator: Integrator, step_s: float) -> mujoco.MjModel:
    """A copy of a scene's model set up for an integrator and a step [s]."""
    copy: mujoco.MjModel = scene.model.__copy__()
    fast = integrator is Integrator.FAST
    kind = mujoco.mjtIntegrator.mjINT_EULER if fast else mujoco.mjtIntegrator.mjINT_RK4
    lag = mujoco.mjtDyn.mjDYN_FILTEREXACT if fast else mujoco.mjtDyn.mjDYN_FILTER
    copy.opt.timestep, copy.opt.integrator = step_s, kind
    _same_for_any_pool(copy, scene)
    copy.actuator_dyntype[:] = lag
    copy.numeric_data[SCHEME] = AVERAGED if fast else INSTANT
    set_fenders(copy, scene, step_s, ahead=fast)
    return copy


def _same_for_any_pool(model: mujoco.MjModel, scene: Scene) -> None:
    """Let the solver's sums and its tolerance not depend on the number of bodies for items.

    MuJoCo takes the sparse solver from 60 degrees of freedom on, whose sums have another order; the
    dense one takes 1.4 times as long with 24 bodies, 3.5 times with 75. It stops by a tolerance
    times the sum of the inertia: here the vessels'.
    """
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    inertia = sum(2.0 * one.mass_kg + one.inertia_z_kgm2 for one in scene.vessels)
    model.stat.meaninertia = inertia / model.nv


def half_step_s(integrator: Integrator, step_s: float) -> float:
    """Time by which positions run ahead of velocities [s]."""
    return 0.5 * step_s if integrator is Integrator.FAST else 0.0


def check_lags(scene: Scene, step_s: float) -> None:
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
