"""Commands that list what ships, and check maps."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from mjforage.base.errors import UserError
from mjforage.cli.console import OUT, app, output, print_file, print_list
from mjforage.cli.flags import Water

if TYPE_CHECKING:
    from mjforage.scenario.maps import GridMap
    from mjforage.scenario.scenario import Scenario

MAP_RULES = ("corner_cutting", "largest_component", "water")  # keys by which a map is read


@app.command
def policies() -> None:
    """List the policies, with the source of those that installed packages bring."""
    from mjforage.graph_planner.policies.registry import POLICIES, policy_names, policy_summary

    def words(name: str) -> str:
        origin = POLICIES.origin(name)
        return f"{policy_summary(name)} [{origin}]" if origin else policy_summary(name)

    print_list((name, _told(words, name)) for name in policy_names())


@app.command
def metrics() -> None:
    """List the metrics: definition, unit, and the better direction of each."""
    from mjforage.mission.scoring import METRICS, chosen_metrics, description

    ways = {1: "more is better", -1: "less is better", 0: ""}

    def words(name: str) -> str:
        (one,) = (one for one in chosen_metrics([name]) if one is METRICS.find(name))
        about = description(one)
        facts = ", ".join(filter(None, (about.unit, ways[about.better], METRICS.origin(name))))
        return f"{about.definition} [{facts}]" if facts else about.definition

    ours = [one.key for one in chosen_metrics()]
    others = [name for name in METRICS.names() if name not in ours]
    print_list((name, _told(words, name)) for name in (*ours, *others))


def _told(words: Callable[[str], str], name: str) -> str:
    """Words on a name, or why it cannot be used: a package that is broken spoils no list."""
    try:
        return words(name)
    except UserError as error:
        return str(error)


@app.command
def scenarios(scenario: str | None = None, /, *, explain: str | None = None) -> None:
    """List the scenarios that ship, print the file of one, or explain a key.

    Parameters
    ----------
    scenario
        Name of a preset, so that `mjforage scenarios comb-port > mine.toml` copies its file; keys
        that it does not name have their defaults.
    explain
        Key of a scenario, such as weather.gust_intensity, or a table of it, such as team.scouts.
    """
    from mjforage.physics.vessel_moves import followed, open_setup
    from mjforage.scenario.roles import FROM_VESSEL
    from mjforage.scenario.scenario_file import load_scenario, preset_names, scenario_path

    if scenario is not None and explain is not None:
        raise UserError(f"scenarios {scenario} --explain {explain}: give one of them")
    if scenario is not None:
        found = load_scenario(scenario)
        open_end = any(role.moves == FROM_VESSEL for role in found.team.values())
        lines = followed(open_setup(found)) if open_end else ()
        print_file(scenario_path(scenario), *(f"# {line}\n" for line in lines))
        return
    if explain is not None:
        from mjforage.scenario.scenario import Scenario
        from mjforage.scenario.schema import explain as rows_of

        print_list((row.key, row.words) for row in rows_of(Scenario, explain))
        return
    print_list((name, load_scenario(name).description) for name in preset_names())


@app.command
def maps(
    map: str | None = None,
    /,
    *,
    water: Water | None = None,
    set: Annotated[tuple[str, ...], Parameter(negative="")] = (),
    output_file: Annotated[Path | None, OUT] = None,
) -> None:
    """List the maps, or check one and draw it.

    Parameters
    ----------
    map
        Name of a shipped map, harbour:KIND:SEED[:ROWSxCOLUMNS] for a generated one,
        harbours:[KIND:]FIRST-LAST for several, or path of a table (CSV, text) or an image.
    water
        Cells of a file that are water, light or dark: pixels of an image, 1 or 0 of a table.
    set
        Override KEY=VALUE of a scenario's map, as of evaluate: map.largest_component=true,
        map.corner_cutting=true or map.water=dark; repeatable.
    output_file
        File to write: a picture, for example port.png, or the map itself as port.csv.
    """
    from mjforage.scenario.harbours import family, is_family
    from mjforage.scenario.map_files import shipped_maps
    from mjforage.scenario.maps import load_map

    several = map is not None and is_family(map)
    names = family(map) if map and several else (map,) if map else shipped_maps()
    choice = _map_scenario(set, water).map
    rules = {name: getattr(choice, name) for name in MAP_RULES}
    grids = [load_map(name, **rules) for name in names]
    for grid in grids:
        rows, columns = grid.navigable.shape
        output.print(f"{grid.name}: {rows} x {columns}, {grid.nodes} nodes")
    if output_file is not None and map:
        _write(grids, output_file)


def _map_scenario(overrides: tuple[str, ...], water: Water | None) -> "Scenario":
    """A scenario that says how a map is read, by overrides of its keys."""
    from mjforage.scenario.scenario_file import load_scenario

    names = " or ".join(f"map.{name}" for name in MAP_RULES)
    for override in overrides:
        if override.partition("=")[0].strip() not in names.split(" or "):
            raise UserError(f"--set {override}: gives a map no other nodes; give {names}")
    return load_scenario("open-bay", overrides, water=water)


def _write(grids: "list[GridMap]", path: Path) -> None:
    """A map as a table or a picture, or several on one sheet."""
    from mjforage.scenario.map_files import write_table
    from mjforage.view.figures.map_pictures import save_map_picture

    if len(grids) == 1 and path.suffix.lower() == ".csv":
        write_table(grids[0].navigable, path)
    else:
        save_map_picture(grids, path)
    kind = "map" if path.suffix.lower() == ".csv" else "picture"
    output.print(f"{kind}: {path}", soft_wrap=True)
