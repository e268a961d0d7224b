"""README of an exported scene: how to use it, and the forces that mjforage's callback adds."""

from collections.abc import Sequence
from functools import reduce
from importlib.metadata import version
from typing import Any

import mujoco

from mjforage.mission.setup import Setup
from mjforage.physics.hydrodynamics.parameters import AIR_DENSITY_KGPM3
from mjforage.physics.scene import DebrisClass, load_debris
from mjforage.physics.scene.debris import WATER_DENSITY_KGPM3
from mjforage.physics.simulation import Integrator
from mjforage.physics.vessels import Vessel
from mjforage.runs.episode_recording import Recording
from mjforage.scenario.schema import rows

_BODY = ("added_", "linear_", "quadratic_", "yaw_", "lag_")
_TABLES = ("thruster.", "crossflow.", "windage.", "load.")
_TEXT = """\
# Scenario {name} in MuJoCo

Written by mjforage {version} with MuJoCo {mujoco}: {episode}.

| file | content |
|---|---|
| `scene.xml` | quays, the map's edge, vessels, items; a keyframe per decision, of {period_s:g} s |
| `tracks.csv` | every recorded pose: `t_s,vessel,x_m,y_m,yaw_rad`, a frame each {frame_s:g} s |

```python
import mujoco

model = mujoco.MjModel.from_xml_path("scene.xml")
data = mujoco.MjData(model)
mujoco.mj_resetDataKeyframe(model, data, model.key("decision-0").id)
data.ctrl[model.actuator("{vessel}/port").id] = 20.0  # N
mujoco.mj_step(model, data)
```

Units are SI. World axes are x east, y north, z up; yaw is 0 at east, counter-clockwise. Positions
are those of midships. `qpos` is x, y, yaw of each vessel, then x, y of each item. An item that is
not on the water lies in a row beyond the south-west corner. Keyframes hold positions, not
velocities. Numbers in `scene.xml` have six digits. Each vessel NAME has the body `NAME/hull` and
the motors `NAME/port` and `NAME/starboard`. Their control is the thrust [N].

`scene.xml` has RK4 with steps of {reference_s:g} s, as mjforage's integrator `reference`. The
scenario itself is stepped with `{integrator}`, in steps of {step_s:g} s; `fast` is Euler with
forces that are averaged over the step.

## Forces that are not in the scene

mjforage adds these in a passive callback. Without them, only contacts slow a vessel or an item.
u, v are the velocity of midships relative to the water, ahead and to port, and r is the yaw rate;
X, Y act ahead and to port, N counter-clockwise. The callback turns them into world axes.

- **Added mass** joins the mass matrix: surge and sway, turned by the yaw, and yaw. With d = sway -
  surge: X = d v r, Y = d u r, N = -d u v.
- **Damping**: X = -(linear_surge + quadratic_surge |u|) u, Y the same with v,
  N = -(linear_yaw (1 + yaw_linear_growth |r|) + quadratic_yaw |r|) r.
- **Cross-flow**: Y = -1/2 rho Cd T times the integral of |v + x r| (v + x r) over the length x, N
  the same with x times the integrand.
- **Wind load**: Blendermann (1994), from the velocity of the air past the vessel, {air:g} kg/m3.
- **Thrusters**: k n |n| of a propeller's speed n, or the force outside the dead zone, behind a
  first-order lag of the command. The motors here give their force at once.
- **Load**: each item aboard adds mass at midships and quadratic drag ahead.
- **Items**: 1/2 rho C A |w| w of the air ({air:g} kg/m3) and the water ({water:g} kg/m3) that pass
  at w; added mass. Their contacts are as soft as for MuJoCo's default density, not for their mass.

{vessels}
{items}"""


def readme(setup: Setup, recording: Recording, vessels: Sequence[Vessel]) -> str:
    """The page, with the numbers of the fleet as it moves and of the items of the episode."""
    choice, policy = setup.scenario.physics, recording.policy
    played = f"{policy} in world {recording.world}" if policy else "its start"
    integrator, known = Integrator(choice.integrator), load_debris()
    kinds = [known[k] for k in sorted({*recording.item_class.tolist()} - {-1})]
    return _TEXT.format(
        name=setup.scenario.name,
        version=version("mjforage"),
        mujoco=mujoco.__version__,
        episode=f"episode {recording.episode} of seed {recording.seed}, {played}",
        period_s=recording.period_s,
        frame_s=recording.frame_s,
        vessel=recording.labels[0],
        reference_s=Integrator.REFERENCE.step_s,
        integrator=integrator.value,
        step_s=choice.step_s or integrator.step_s,
        air=AIR_DENSITY_KGPM3,
        water=WATER_DENSITY_KGPM3,
        vessels=_table(Vessel, {one.name: one for one in vessels}, _BODY + _TABLES),
        items=_table(DebrisClass, {one.name: one for one in kinds}, ("added_", "area_", "drag_")),
    )


def _table(schema: type, parts: dict[str, Any], wanted: tuple[str, ...]) -> str:
    """Values of all parts, a column each, for keys that begin as `wanted`."""
    lines = [f"| key | {' | '.join(parts)} | unit | meaning |", "|---" * (3 + len(parts)) + "|"]
    for row in {one.key: one for one in rows(schema)}.values():
        values = [reduce(_value, row.key.split("."), part) for part in parts.values()]
        if row.key.startswith(wanted) and not row.table and any(one is not None for one in values):
            cells = ["-" if v is None else v if isinstance(v, str) else f"{v:g}" for v in values]
            meaning = row.sentence.replace("|", "\\|") if not row.key.endswith(".kind") else ""
            lines.append(f"| `{row.key}` | {' | '.join(cells)} | {row.unit} | {meaning} |")
    return "\n".join(lines) + "\n"


def _value(part: Any, key: str) -> Any:
    return getattr(part, key, None)
