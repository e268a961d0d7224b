"""Scenario files: strict TOML to `Scenario`, overrides, and the canonical form that is hashed.

Strict means: an unknown key, a wrong type, a missing key or a number out of range is one error that
names the file, the key, the value and what was expected.
"""

import dataclasses
import difflib
import itertools
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, cast

from mjforage.base.errors import UserError
from mjforage.base.references import assigned
from mjforage.base.toml_files import read_toml
from mjforage.scenario.assets import named_file, shipped_files
from mjforage.scenario.faults import check_faults
from mjforage.scenario.harbours import is_harbour
from mjforage.scenario.link import SCAN_BYTES, Link
from mjforage.scenario.map_files import is_shipped_map
from mjforage.scenario.place import is_place
from mjforage.scenario.scenario import Scenario, Weather
from mjforage.scenario.schema import NAME, check, rows, shown
from mjforage.scenario.sensors import POSITIONING_KEYS, Sensors

Tree = dict[str, Any]


def preset_names() -> list[str]:
    """Names of the scenarios that ship with the package."""
    return list(shipped_files("scenarios", ".toml"))


def scenario_path(reference: str) -> Path:
    """File of a preset's name or of a path.

    Raises
    ------
    UserError
        If there is no such preset or file.
    """
    shipped = shipped_files("scenarios", ".toml")
    return named_file("scenario", reference, shipped, "a TOML file", ".toml")


def load_scenario(
    reference: str,
    overrides: Iterable[str] = (),
    map_file: str | None = None,
    water: str | None = None,
) -> Scenario:
    """Read a preset or a file, replace the grid, then apply `KEY=VALUE` overrides in order.

    A file may begin with `extends`: what it lacks is as in that scenario. Paths in a file start
    from the folder of that file, those of overrides from the working directory.

    Parameters
    ----------
    reference : name of a preset, or path of a TOML file
    overrides : for example `team.scouts.count=3`; values in TOML syntax, bare words are strings
    map_file : replaces `map.file`, and `map.water` by its default; everything else stays, starts
        too unless it is a generated harbour, where a cluster is drawn, or a place
    water : replaces `map.water`

    Raises
    ------
    UserError
        For anything that is not a valid scenario.
    """
    path = scenario_path(reference)
    tree = _extended(path)
    if map_file is not None:
        _put(tree, ["map", "file"], map_file, f"map {map_file}")
        tree["map"].pop("water", None)
        if is_harbour(map_file):
            _put(tree, ["map", "starts"], [], f"map {map_file}")
        elif is_place(map_file):
            for key in ("starts", "pitch_m"):
                tree["map"].pop(key, None)
    if water is not None:
        _put(tree, ["map", "water"], water, f"water {water}")
    teams, overrides = tree.get("team"), list(overrides)
    names = list(teams) if isinstance(teams, dict) else []
    for override in overrides:
        _apply(tree, override)
    try:
        return scenario_from_tree(tree, f"scenario {path.stem}")
    except UserError as error:
        raise _near_miss(overrides, names, error) or error from error


def _extended(path: Path, *above: Path) -> Tree:
    """The tree of a file, laid over that of the scenario which it extends."""
    tree = read_toml(path, f"scenario {path.name}")
    _start_paths(tree, path.parent)
    if "extends" not in tree:
        return tree
    base = tree.pop("extends")
    where = f"scenario {path.stem}: extends = {shown(base)}"
    if not isinstance(base, str):
        raise UserError(f"{where}, expected the name of a scenario or a TOML file")
    below = scenario_path(base if base in preset_names() else str(path.parent / base))
    if below.resolve() in (one.resolve() for one in (*above, path)):
        raise UserError(f"{where}: leads back to {path.name}; name another scenario")
    tree.setdefault("name", path.stem)
    found = _extended(below, *above, path)
    if isinstance(choice := tree.get("map"), dict) and "file" in choice:
        found.pop("map", None)  # pitch and starts are of the other map
    return _laid_over(found, tree)


def _laid_over(below: Tree, above: Tree) -> Tree:
    """Both trees; where both have a value, that of `above`."""
    both = {key: below[key] for key in above if key in below}
    merged = {
        key: _laid_over(value, above[key])
        for key, value in both.items()
        if isinstance(value, dict) and isinstance(above[key], dict)
    }
    return below | above | merged


def with_extends(schema: Tree) -> Tree:
    """The JSON Schema of scenario files: what is required is so in a file without `extends`."""
    words = "Scenario that this one extends: a name, or a file; what is not given is as there."
    properties = {"extends": {"description": words, "type": "string"}, **schema["properties"]}
    tables = {key: dict(table) for key, table in schema["$defs"].items()}
    choice, role = ({"required": tables[key].pop("required")} for key in ("MapChoice", "Role"))
    needed = {"map": choice, "team": {"additionalProperties": role}}
    whole = {"required": schema["required"], "properties": needed}
    rest = {key: value for key, value in schema.items() if key != "required"}
    return rest | {
        "properties": properties,
        "if": {"not": {"required": ["extends"]}},
        "then": whole,
        "$defs": tables,
    }


def _near_miss(overrides: list[str], teams: list[str], error: UserError) -> UserError | None:
    """The error of an override whose key is not known but nearly one that is; None if the error
    says so itself.
    """
    known = set()
    for row in rows(Scenario):
        table, name, rest = row.key.partition(f".{NAME}")
        known |= {f"{table}.{team}{rest}" for team in teams} if name else {row.key}
    for override in overrides:
        key = override.partition("=")[0].strip()
        close = [one for one in sorted(known) if one.endswith(f".{key}")]
        close = close or difflib.get_close_matches(key, known, n=1, cutoff=0.9)
        if close and key not in known and close[0] not in str(error):
            fault = str(error).partition("; did you mean ")[0]
            return UserError(f"set {override}: did you mean {close[0]}? As it is, {fault}")
    return None


def with_overrides(scenario: Scenario, overrides: Iterable[str]) -> Scenario:
    """The scenario after `KEY=VALUE` overrides, as of `load_scenario`."""
    tree = scenario_to_tree(scenario)
    for override in overrides:
        _apply(tree, override)
    return scenario_from_tree(tree, f"scenario {scenario.name}")


def _start_paths(tree: Tree, folder: Path) -> None:
    """Let the paths of a file's map and vessels start from its folder; names stay as they are."""
    choice, physics, weather = (tree.get(table) for table in ("map", "physics", "weather"))
    if isinstance(weather, dict) and isinstance(weather.get("file"), str):
        weather["file"] = str(folder / weather["file"])
    if isinstance(choice, dict) and isinstance(file := choice.get("file"), str):
        named = is_shipped_map(file) or is_harbour(file)
        choice["file"] = file if named else str(folder / file)
    vessels = physics.get("vessels") if isinstance(physics, dict) else None
    if not isinstance(vessels, dict):
        return
    for team, vessel in vessels.items():
        if isinstance(vessel, str) and vessel.endswith(".toml"):
            vessels[team] = str(folder / vessel)


def _apply(tree: Tree, override: str) -> None:
    key, separator, text = override.partition("=")
    parts = key.strip().split(".")
    if not separator or not all(parts):
        raise UserError(f"set {override}: expected KEY=VALUE, for example team.scouts.count=3")
    if any("\ud800" <= letter <= "\udfff" for letter in override):
        raise UserError(f"set {override!r}: is not UTF-8")
    document = assigned(text)
    if len(document) > 1:
        raise UserError(f"set {override!r}: expected one value")
    _put(tree, parts, document["value"], f"set {override}")


def _put(tree: Tree, parts: list[str], value: object, where: str) -> None:
    table = tree
    for part in parts[:-1]:
        table = table.setdefault(part, {})
        if not isinstance(table, dict):
            raise UserError(f"{where}: {part} is a value, not a table")
    table[parts[-1]] = value


def scenario_from_tree(tree: Tree, where: str) -> Scenario:
    """The scenario of nested dicts, as TOML has them or `scenario_to_tree` gives them.

    Parameters
    ----------
    where : start of error messages

    Raises
    ------
    UserError
        For an unknown or missing key, a wrong type, a value out of range, or tables that contradict
        each other.
    """
    weather = tree.get("weather")
    if isinstance(weather, dict) and "current_toward_deg" in weather:
        raise UserError(
            f"{where}: weather.current_toward_deg = {shown(weather['current_toward_deg'])} counted "
            "from east; give weather.current_to_deg, clockwise from true north: 90 less that number"
        )
    scenario = check(Scenario, tree, where)
    name = scenario.name
    if not name.isprintable() or not name.strip(" .") or set(name) & set("/\\"):
        raise UserError(
            f"{where}: name = {shown(name)} names the run folder; give letters, digits and dashes"
        )
    counts = {name: role.count for name, role in scenario.team.items()}
    if not 1 <= sum(counts.values()) <= 255:
        raise UserError(f"{where}: {sum(counts.values())} agents in all; give 1 to 255")
    for team in counts:
        if not team.replace("-", "").replace("_", "").isalnum():
            raise UserError(
                f"{where}: team.{shown(team)} names files; give letters, digits and dashes"
            )
    order = scenario.rules.order
    if order and sorted(order) != sorted(counts):
        raise UserError(
            f"{where}: rules.order = {shown(list(order))}; give every team once: "
            f"{', '.join(counts)}"
        )
    if scenario.rules.jump and scenario.rules.shorten:
        raise UserError(
            f"{where}: rules.jump = true with rules.shorten = true: moves that jump are never made "
            "shorter; give rules.shorten = false"
        )
    if not scenario.rules.start_seen and scenario.link.model != "ideal":
        raise UserError(
            f'{where}: rules.start_seen = false with link.model = "{scenario.link.model}"; over a '
            "link all that is received counts as seen: leave one of them out"
        )
    origin, speed = scenario.weather.wind_from_deg, scenario.weather.wind_speed_mps
    if origin is not None and speed is None:
        raise UserError(
            f"{where}: weather.wind_from_deg = {origin:g} without a wind; give "
            "weather.wind_speed_mps too"
        )
    for key in "wind", "current":
        spread = getattr(scenario.weather, f"{key}_spread")
        if spread and not getattr(scenario.weather, f"{key}_speed_mps"):
            raise UserError(
                f"{where}: weather.{key}_spread = {spread:g} without a {key}; give "
                f"weather.{key}_speed_mps too"
            )
    of_record = ("start", "record_height_m", "height_m", "shear_exponent")
    unused = [k for k in of_record if getattr(scenario.weather, k) != getattr(Weather(), k)]
    if scenario.weather.file is None and unused:
        raise UserError(f"{where}: weather.{unused[0]} without a record; give weather.file too")
    if scenario.weather.file is not None and scenario.weather.drift == "constant":
        raise UserError(
            f"{where}: weather.drift = 'constant' with weather.file: a recorded wind changes; "
            "leave out weather.drift"
        )
    for least, largest in scenario.weather.drift_ranges_node_per_step or ():
        if least > largest:
            raise UserError(
                f"{where}: weather.drift_ranges_node_per_step: [{least:g}, {largest:g}]; give the "
                "least drift first"
            )
    physics = scenario.physics
    if physics.intake_jam_items and physics.intake_rate_per_s is None:
        raise UserError(
            f"{where}: physics.intake_jam_items = {physics.intake_jam_items} without a rate; give "
            "physics.intake_rate_per_s too, or 0"
        )
    unused = [f.name for f in dataclasses.fields(Link)]
    unused = [k for k in unused[1:] if getattr(scenario.link, k) != getattr(Link(), k)]
    if scenario.link.model == "ideal" and unused:
        value = shown(getattr(scenario.link, unused[0]))
        raise UserError(
            f"{where}: link.{unused[0]} = {value} without a link; give link.model, for example disk"
        )
    least = scenario.link.loss / (1.0 - scenario.link.loss)
    if 1.0 < scenario.link.burst < least:
        raise UserError(
            f"{where}: link.burst = {scenario.link.burst:g} is too short to lose "
            f"{scenario.link.loss:.1%}; give at least {least:.4g}, or 1 for independent losses"
        )
    if 0 < scenario.link.bytes < SCAN_BYTES:
        raise UserError(
            f"{where}: link.bytes = {scenario.link.bytes} is too little for any scan; give at "
            f"least {SCAN_BYTES}, 0 for no limit, or link.model = none"
        )
    table = scenario.sensors.detection_table
    for (near, more), (far, less) in itertools.pairwise(table):
        if far <= near or less > more:
            raise UserError(
                f"{where}: sensors.detection_table: [{far:g}, {less:g}] after [{near:g}, {more:g}];"
                " give growing distances with chances that do not grow"
            )
    if table and scenario.sensors.half_range_node:
        raise UserError(
            f"{where}: sensors.half_range_node = {scenario.sensors.half_range_node:g} beside a "
            "detection_table; give one of them"
        )
    sensors = scenario.sensors
    surest = table[0][1] if table else sensors.detection
    if sensors.persistence > 0.0 and surest in (0.0, 1.0):
        raise UserError(
            f"{where}: sensors.persistence = {sensors.persistence:g}, but all items are detected "
            f"with the same chance of {surest:g} near by; give sensors.detection between 0 and 1"
        )
    if sensors.map == "filtered" and sensors.perfect:
        raise UserError(
            f'{where}: sensors.map = "filtered", but scans are perfect; give '
            "sensors.detection, for example 0.9"
        )
    unused = [k for k in POSITIONING_KEYS[3:] if getattr(sensors, k) != getattr(Sensors, k)]
    if sensors.positioning == "white" and unused:
        raise UserError(
            f"{where}: sensors.{unused[0]} = {shown(getattr(sensors, unused[0]))} with "
            'sensors.positioning = "white", which has no such error; give "gnss"'
        )
    choice = scenario.corruption
    if choice.team not in counts and (choice.team or choice.epsilon):
        teams = ", ".join(counts)
        raise UserError(f"{where}: corruption.team = {choice.team!r}; choose {teams}")
    for name in scenario.physics.vessels:
        if name not in counts:
            teams = ", ".join(counts)
            raise UserError(f"{where}: physics.vessels.{name}: no such team; known: {teams}")
    check_faults(scenario.faults, counts, where)
    return scenario


def with_values(scenario: Scenario, values: Mapping[str, object], where: str) -> Scenario:
    """The scenario with some keys, such as `link.range_m`, set to other values.

    Raises
    ------
    UserError
        As `scenario_from_tree`.
    """
    tree = scenario_to_tree(scenario)
    for key, value in values.items():
        _put(tree, key.split("."), value, f"{where}: {key}")
    return scenario_from_tree(tree, where)


def scenario_to_tree(scenario: Scenario) -> Tree:
    """The scenario as nested dicts and lists, every key present; `scenario_from_tree` undoes it."""

    def plain(value: Any) -> Any:
        if dataclasses.is_dataclass(value):
            return {f.name: plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
        if isinstance(value, Mapping):
            return {name: plain(entry) for name, entry in value.items()}
        return [plain(entry) for entry in value] if isinstance(value, tuple) else value

    return cast(Tree, plain(scenario))


def canonical_json(tree: object) -> str:
    """JSON without blanks. Keys keep their order, because the order of teams numbers the agents."""
    return json.dumps(tree, separators=(",", ":"), allow_nan=False)
