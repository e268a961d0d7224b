"""Fenders between hulls and quays: as stiff as the time step allows.

A rubber rail stops a hull of 12 to 200 kg within centimetres, in less than a step. So a fender is a
damper that takes the way off and gives almost nothing back, with a spring that holds thrust and
wind. Both are rates, per kg of the inertia that MuJoCo finds behind a contact, added mass included.
"""

import mujoco
import numpy as np

from mjforage.physics.scene import Scene
from mjforage.physics.scene.quays import BANK, ITEM
from mjforage.physics.vessel_models import top_speed

QUAY, HULL = 1, 2  # bits of contacts, as models/*.xml have them
STOPPING_PER_S = 100.0
"""Damping c/m of a fender [1/s]: 3.8 kN s/m before a scout. Estimate for a rail of 5 cm: a hull
goes (m/c) v deep, 36 mm at 3.6 m/s, and up to 1 cm more for meeting it amid a step of 20 ms."""
STIFFNESS = 0.02
"""Stiffness k/m over (c/m)^2: 200/s^2, 7.7 kN/m before a scout. Estimate: so low that a hull gets 2
to 3 % of its speed back; MuJoCo's impedance holds full thrust within 1 mm."""
IMPEDANCE = 0.99  # of MuJoCo's contacts, from 0 (none) to 1 (rigid); nearer to 1 it iterates more
FRICTION = 4.0
"""Impedance of friction over that of the normal force, for Runge-Kutta's fenders, which are softer:
an Otter that full thrust presses into a corner creeps by 0.5 mm/s, and by 2.7 mm/s at 1."""
DRIFT_MPS = 1.0  # by which water and wind may make a hull faster over ground than its thrust


def set_fenders(model: mujoco.MjModel, scene: Scene, step_s: float, *, ahead: bool) -> None:
    """Set contacts of hulls with quays and each other, for steps of `step_s`.

    Runge-Kutta integrates the fender, with a rate of at most 2 / `step_s`. With `ahead`, the fast
    integrator looks for contacts as far as the vessels go in a step, and lets the step end at the
    face (`callback.contact_rows`): the limit of a fender whose stroke is short.
    """
    rate = 1.0 / step_s if ahead else min(STOPPING_PER_S, 2.0 / step_s)
    stiffness = rate**2 if ahead else STIFFNESS * rate**2
    kind = model.geom_contype
    fenders = (kind == HULL) | (kind == QUAY) | (kind == BANK)
    model.geom_solref[fenders] = -stiffness, -rate
    model.geom_solimp[fenders, :2] = IMPEDANCE
    model.opt.impratio = 1.0 if ahead else FRICTION
    if ahead:  # margins of a pair add up
        reach = step_s * (max(map(top_speed, scene.vessels)) + DRIFT_MPS)
        model.geom_margin[fenders], model.geom_margin[kind == ITEM] = reach, -reach
        for geom in np.flatnonzero(kind):
            model.body_margin[model.geom_bodyid[geom]] = model.geom_margin[geom]
