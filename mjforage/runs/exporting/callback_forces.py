"""README of an exported scene: how to use it, and the forces that mjforage's callback adds."""

from collections.abc import Sequence
from functools import reduce
from importlib import resources
from importlib.metadata import version
from typing import Any

import mujoco

from mjforage.controllers.propulsion import WATER_DENSITY_KGPM3
from mjforage.mission.setup import Setup
from mjforage.physics.simulation import Integrator
from mjforage.physics.vessels import Vessel
from mjforage.runs.episode_recording import Recording
from mjforage.scenario.debris import AIR_DENSITY_KGPM3, DebrisClass, load_debris
from mjforage.scenario.schema import rows

_BODY = ("added_", "linear_", "quadratic_", "yaw_", "lag_")
_TABLES = ("thruster.", "power.propeller_m", "power.motor_w", "crossflow.", "windage.", "load.")


def readme(setup: Setup, recording: Recording, vessels: Sequence[Vessel]) -> str:
    """The page, with the numbers of the fleet as it moves and of the items of the episode."""
    choice, policy = setup.scenario.physics, recording.policy
    played = f"{policy} in world {recording.world}" if policy else "its start"
    integrator, known = Integrator(choice.integrator), load_debris()
    kinds = [known[k] for k in sorted({*recording.item_class.tolist()} - {-1})]
    text = resources.files(__package__).joinpath("scene_readme.txt").read_text(encoding="utf-8")
    return text.rstrip("\n").format(
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
