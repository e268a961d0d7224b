"""Proof that the installed callback reads and writes the right memory, on a model of one vessel."""

import math

import mujoco
import numpy as np

from mjforage.physics.callback.model_layout import HEADER_NAME, INSTANT, MAGIC, VESSEL_INPUTS, WATER
from mjforage.physics.hydrodynamics.parameters import VESSEL

MASS, ADDED_SURGE, ADDED_SWAY, ADDED_YAW, INERTIA = 100.0, 50.0, 200.0, 5.0, 20.0
DRAG, TOLERANCE = 10.0, 1e-9

_TOY = f"""
<mujoco>
  <option gravity="0 0 0" timestep="0.01"/><size nuserdata="{VESSEL_INPUTS}"/>
  <custom>
    <numeric name="{HEADER_NAME}" data="{MAGIC!r} 1 0 0 {INSTANT}"/>
    <numeric name="vessel" data="{{parameters}}"/>
  </custom>
  <worldbody>
    <body name="hull">
      <joint name="x" type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
      <joint type="hinge" axis="0 0 1"/>
      <inertial pos="1e-6 0 0" mass="{MASS}" diaginertia="{INERTIA} {INERTIA} {INERTIA}"/>
    </body>
  </worldbody>
  <actuator>
    <general joint="x" dyntype="filter" gainprm="0"/>
    <general joint="x" dyntype="filter" gainprm="0"/>
  </actuator>
</mujoco>
"""


def toy_model() -> mujoco.MjModel:
    """A vessel with linear drag only, so that a push by a current has a known answer."""
    record = np.zeros(1, VESSEL)
    p = record[0]
    p.mass, p.inertia_z, p.lag = MASS, INERTIA, 1.0
    p.added_surge, p.added_sway, p.added_yaw = ADDED_SURGE, ADDED_SWAY, ADDED_YAW
    p.linear_surge = p.linear_sway = DRAG
    return mujoco.MjModel.from_xml_string(
        _TOY.format(parameters=" ".join(repr(float(value)) for value in record.view(np.float64)))
    )


def failure(model: mujoco.MjModel) -> str | None:
    """The fault of the callback in place, seen on `toy_model()`, or None.

    A current of 1 m/s along x pushes a resting vessel with 10 N. Along the vessel it has to
    accelerate it by 10/(m + X_a), across it by 10/(m + Y_a), at any heading.
    """
    data = mujoco.MjData(model)
    data.userdata[WATER] = 1.0
    for yaw in np.linspace(0.0, math.tau, 9):
        data.qpos[2] = yaw
        mujoco.mj_forward(model, data)
        c, s = math.cos(yaw), math.sin(yaw)
        munk = -(ADDED_SWAY - ADDED_SURGE) * (-c) * s
        ahead, aside = c * DRAG / (MASS + ADDED_SURGE), -s * DRAG / (MASS + ADDED_SWAY)
        expected = c * ahead - s * aside, s * ahead + c * aside, munk / (INERTIA + ADDED_YAW)
        error = float(np.max(np.abs(data.qacc - expected)))
        if not error < TOLERANCE:
            return (
                f"acceleration of a resting vessel at heading {yaw:.2f} rad is off by {error:.3g}"
            )
    return None
