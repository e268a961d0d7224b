"""Scenes: small missions played with an option at its default and changed.

They are data, the `scenes-*.toml` of this folder. An option of a policy, or a key of `[prior]`, is
played by two policies that are shown the same mission, step by step: what differs is what they
decide. Any other key of a scenario is played by two missions: what differs is what is in them.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.references import parse_reference
from mjforage.graph_planner.policies import create_policy, policy_names
from mjforage.graph_planner.policies.registry import policy_class
from mjforage.mission.mission import Mission
from mjforage.mission.policy import Policy
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario
from mjforage.scenario.schema import rows

HERE = Path(__file__).resolve().parent
FORECAST = "forecast"


@dataclass(frozen=True)
class Scene:
    """An option, the value that it is changed to, and a mission in which that is looked at.

    Attributes
    ----------
    option : of a policy, `greedy.item`, or a key of a scenario
    value : as on the command line
    changes : all that differs: teams whose moves do, and `forecast`; or parts of the mission, see
        `mission_parts`, and `end`, when it is over
    set : overrides of both
    also : overrides of the changed one alone
    policy : which plays, with options of its own if need be; absent: the option's
    base : in `bases.toml`
    """

    option: str
    value: str
    changes: str
    set: str = ""
    also: str = ""
    policy: str = ""
    base: str = "small"
    seed: int = 0
    steps: int = 20
    world: str = "graph"

    def __str__(self) -> str:
        more = " ".join(filter(None, (self.set, self.also)))
        return f"{self.option}={self.value}" + f" ({more})" * bool(more)

    @property
    def player(self) -> str:
        """Reference of the policy that plays the option's default."""
        return self.policy or self.option.partition(".")[0]


def scenes(file: str) -> list[Scene]:
    """All scenes of `scenes-FILE.toml`."""
    tables = _read(f"scenes-{file}.toml")
    return [Scene(**tables["common"] | entry) for entry in tables["scenes"]]


def excused() -> dict[str, str]:
    """Option -> why no scene shows that it does something."""
    return _read("excused.toml")


@cache
def _bases() -> Mapping[str, list[str]]:
    """Name -> overrides of the preset open-bay."""
    return {name: table["set"] for name, table in _read("bases.toml").items()}


def _read(name: str) -> dict[str, Any]:
    return tomllib.loads((HERE / name).read_text(encoding="utf-8"))


def policy_options() -> dict[str, object]:
    """Every option of every policy, `greedy.item`, and its default."""
    return {
        f"{name}.{option}": parameter.default
        for name in policy_names()
        for option, parameter in signature(policy_class(name)).parameters.items()
    }


def scenario_keys() -> dict[str, str]:
    """Every key of a scenario that is no table, and its default."""
    return {row.key: row.default for row in rows(Scenario) if not row.table}


def key_of(option: str) -> str:
    """A scene's option as keys are listed: `team.NAME.count` for that of any team."""
    for table in ("team.", "physics.vessels."):
        if option.startswith(table):
            _, *rest = option.removeprefix(table).split(".")
            return ".".join([f"{table}NAME", *rest])
    return option


def differences(scene: Scene, value: str = "") -> set[str]:
    """All that differs in a scene if the option has another value, by default the scene's."""
    value = value or scene.value
    if scene.option in policy_options():
        option = f"{scene.option.partition('.')[2]}={value}"
        return _decisions(scene, scene.also.split(), _with_option(scene.player, option))
    changes = [f"{scene.option}={value}", *scene.also.split()]
    if scene.option.startswith("prior."):
        return _decisions(scene, changes, scene.player)
    before, after = _played(scene, []), _played(scene, changes)
    shared = min(len(before["items"]), len(after["items"]))
    found = {part for part in before if before[part][:shared] != after[part][:shared]}
    return found | ({"end"} if len(before["items"]) != len(after["items"]) else set())


def _with_option(policy: str, option: str) -> str:
    before, more = (parse_reference(text, "policy") for text in (policy, f"of({option})"))
    return str(replace(before, options={**before.options, **more.options}))


def overrides_of(base: str, *more: str) -> list[str]:
    """Overrides of the preset open-bay that make a base of it, and more."""
    return [override.replace("HERE", str(HERE)) for override in (*_bases()[base], *more)]


def _mission(scene: Scene, changes: list[str]) -> Mission:
    overrides = overrides_of(scene.base, *scene.set.split(), *changes)
    mission = create_mission(Setup.of(load_scenario("open-bay", overrides)), scene.world)
    mission.reset(scene.seed, np.arange(1))
    return mission


def _decisions(scene: Scene, changes: list[str], other: str) -> set[str]:
    """Teams that decide otherwise, and whether another forecast is made.

    A team has a question mark if its preferences are not the same to the bit but its moves are.
    """
    mission, policies = _mission(scene, []), [create_policy(scene.player), create_policy(other)]
    mission.prepare(policies[0])
    _mission(scene, changes).prepare(policies[1])
    found: set[str] = set()
    for _ in range(scene.steps):
        if not mission.active.any():
            break
        answers = [mission.ask(policy).copy() for policy in policies]
        found |= _unlike(mission, *answers)
        if _forecast(policies[0]) != _forecast(policies[1]):
            found.add(FORECAST)
        mission.advance(answers[0])
    return {part for part in found if part.rstrip("?") == part or part.rstrip("?") not in found}


def _unlike(mission: Mission, one: NDArray[np.float64], other: NDArray[np.float64]) -> set[str]:
    """Teams with other preferences (1, agent, 9), with a question mark if they move alike."""
    fleet = mission.setup.fleet
    moves = [mission.decide(answer).direction[0].copy() for answer in (one, other)]
    unlike = np.flatnonzero((one != other).any(axis=(0, 2)))
    return {
        fleet.team_names[fleet.team[a]] + "?" * bool(moves[0][a] == moves[1][a]) for a in unlike
    }


def _forecast(policy: Policy) -> bytes:
    forecast = getattr(policy, FORECAST, None)
    return b"" if forecast is None else np.ascontiguousarray(forecast()).tobytes()


def _played(scene: Scene, changes: list[str]) -> dict[str, list[bytes]]:
    """What the parts of a mission were at each step."""
    mission, policy = _mission(scene, changes), create_policy(scene.player)
    mission.prepare(policy)
    seen: dict[str, list[bytes]] = {}
    for step in range(scene.steps + 1):
        for part, arrays in mission_parts(mission).items():
            seen.setdefault(part, []).append(b"".join(np.asarray(a).tobytes() for a in arrays))
        if step == scene.steps or not mission.active.any():
            break
        mission.advance(mission.ask(policy))
    return seen


def mission_parts(mission: Mission) -> dict[str, list[NDArray[Any]]]:
    """What there is in a mission of one episode, by the names that scenes have for it."""
    setup, state, pooled, owned = (
        mission.setup,
        mission.state,
        mission.knowledge,
        mission.owner_observation,
    )
    parts: dict[str, list[NDArray[Any]]] = {
        "map": [setup.graph.neighbours],
        "starts": [mission.initial.agent_node],
        "spawn": [mission.initial.item_rc],
        "items": [state.item_rc],
        "taken": [state.collected_by],
        "pooled": [pooled.belief, pooled.last_seen],  # what the fleet knows of items together
        "held": [owned.belief, owned.last_seen],  # what those who decide know of them
        "heard": [owned.agent_node, owned.agent_seen],  # and of each other
        "work": [state.work],
    }
    for i, name in enumerate(setup.fleet.team_names):
        team = setup.fleet.team == i
        parts[name] = [state.agent_rc[:, team], state.agent_yaw[:, team]]
        parts[f"{name}-stores"] = [mission.energy_left[:, team], mission.room_left[:, team]]
    return parts
