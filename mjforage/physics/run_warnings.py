"""Lines before a run: effects missing from worlds or vessels, limits of vessels, derived moves."""

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from mjforage.controllers.legs import REACTION_S
from mjforage.forcing import LEEWAY
from mjforage.forcing.record import far_km
from mjforage.forcing.record_files import read_record
from mjforage.mission.setup import Setup
from mjforage.physics.berth_room import narrow_berths
from mjforage.physics.dynamics.fleet_scene import fleet_vessels
from mjforage.physics.scaled_vessels import scaled
from mjforage.physics.vessel_models import damping_rates, decision_s, full_speed_s, vessel_model
from mjforage.physics.vessel_moves import followed
from mjforage.physics.vessels import NO_LOAD, Vessel, load_vessel
from mjforage.physics.worlds import WORLDS
from mjforage.scenario.faults import Faults
from mjforage.scenario.place import Place
from mjforage.scenario.scenario import Physics, Scenario, Weather
from mjforage.scenario.sensors import POSITIONING_KEYS, Sensors
from mjforage.scenario.vessel_files import hull_names

RK4_LIMIT = 2.785
"""Steps per time constant beyond which Runge-Kutta of order 4 diverges (Hairer and Wanner, "Solving
Ordinary Differential Equations II", section IV.2); the fast integrator's mean accelerations are of
one such step."""
FENDER_STEP_S = 0.02  # longest in which Runge-Kutta has the fenders of `simulation.fenders`
CURRENTS = ("current_speed_mps", "current_wander_mps", "circulation_mps")
FORCED = ("shelter_height_m", *CURRENTS, "item_classes")
"""Keys that forced items of the graph world feel."""
FAR_KM = 50.0  # a record from so far away is told
OF_NO_WIND = "record_height_m", "height_m", "shear_exponent"
OF_NO_RECORD = "drift_node_per_step", "drift_ranges_node_per_step"
"""Keys without effect beside a record without a wind, and beside one with a wind."""
PHYSICAL: tuple[tuple[str, Weather | Sensors | Physics | Faults, tuple[str, ...]], ...] = (
    (
        "weather",
        Weather(),
        ("shelter_height_m", "gust_intensity", *CURRENTS),
    ),
    ("sensors", Sensors(), (*POSITIONING_KEYS, "camera_noise_m")),
    ("faults", Faults(), ("team", "rate_per_h")),
    (
        "physics",
        Physics(),
        ("capture", "item_classes", "integrator", "step_s", "scale", "spread", "device"),
    ),
)
"""Tables of a scenario, as if nothing were given, and their keys that not every world feels."""


def run_warnings(setup: Setup, worlds: Sequence[str]) -> tuple[str, ...]:
    """Lines about a run in these worlds, in the order of their weight; none where all is well."""
    scenario = setup.scenario
    adapted = [WORLDS[world].adapt(scenario) for world in worlds if world != "graph"]
    lines = [*_unfelt_keys(scenario, worlds, adapted), *_still_items(adapted)]
    lines += _of_record(scenario.weather, setup.grid.place)
    lines += _soft_fenders(scenario.physics) if adapted else ()
    lines += _narrow(setup) if adapted else ()
    for vessel, teams in _vessels(setup).items() if adapted else ():
        where = f"vessel {vessel.name} of {' and '.join(teams)}"
        lines += [f"{where}: {words}" for words in _of_vessel(scenario, adapted, vessel, teams)]
    return (*lines, *followed(setup))


def _unfelt_keys(
    scenario: Scenario, worlds: Sequence[str], adapted: Sequence[Scenario]
) -> Iterator[str]:
    """Keys of the scenario that are given and that no world of the run feels.

    `adapted`: the scenario as each world with vessels has it.
    """
    unfelt = [
        f"{table}.{key}"
        for table, nothing, keys in PHYSICAL
        for key in keys
        if (getattr(getattr(scenario, table), key) or None) != (getattr(nothing, key) or None)
        and not any(_feels(each, scenario, table, key) for each in adapted)
        and not ("graph" in worlds and scenario.weather.forced and key in FORCED)
    ]
    if unfelt:
        names = " nor ".join(worlds)
        yield f"{', '.join(unfelt)}: not felt in world {names}, and without effect in this run"


def _of_record(weather: Weather, place: Place | None) -> Iterator[str]:
    """A record from elsewhere, one without a wind, and keys that say nothing beside it."""
    if weather.file is None:
        return
    recorded = read_record(weather.file)
    if place is not None and (away := far_km(recorded, place)) > FAR_KM:
        there = f"{recorded.latitude[0]:.5g}, {recorded.longitude[0]:.5g}"
        yield (
            f"{recorded.name}: is of {there}, {away:.0f} km from the place at "
            f"{place.latitude_deg:.5g}, {place.longitude_deg:.5g}; give one from nearer by"
        )
    nothing, has = Weather(), "no wind" if recorded.wind is None else "the wind"
    unused = [
        f"weather.{key}"
        for key in (OF_NO_WIND if recorded.wind is None else OF_NO_RECORD)
        if getattr(weather, key) != getattr(nothing, key)
    ]
    if unused:
        yield f"{', '.join(unused)}: without effect, as {recorded.name} has {has}; leave it out"
    if recorded.wind is None and weather.wind_speed_mps is None:
        yield (
            f"{recorded.name}: has no wind, so that weather.drift_node_per_step gives one; give "
            "weather.wind_speed_mps, 0 for a calm"
        )


def _still_items(adapted: Sequence[Scenario]) -> Iterator[str]:
    """Currents that move vessels and, by the graph world's rule, no items."""
    currents = [
        f"weather.{key}"
        for key in CURRENTS
        if any(
            one.physics.items == "graph" and not one.weather.forced and getattr(one.weather, key)
            for one in adapted
        )
    ]
    if currents:
        yield (
            f'{", ".join(currents)}: vessels feel it, items do not by physics.items = "graph"; '
            'give "bodies" for items that do'
        )


def _soft_fenders(choice: Physics) -> Iterator[str]:
    """A time step with which the reference integrator's fenders are softer than they shall be."""
    step_s = choice.step_s or FENDER_STEP_S
    if choice.integrator == "reference" and step_s > FENDER_STEP_S:
        yield (
            f'physics.step_s = {step_s:g} with physics.integrator = "reference": fenders '
            f"are soft, and 1 m/s takes a hull {500 * step_s:g} mm and more into a quay; "
            f'give at most {FENDER_STEP_S:g} s, or physics.integrator = "fast"'
        )


def _narrow(setup: Setup) -> Iterator[str]:
    """Berths of a place with too little room."""
    vessels = fleet_vessels(setup.fleet, setup.scenario.physics)
    return narrow_berths(setup.grid, vessels, int(setup.fleet.moves.max()))


def _feels(adapted: Scenario, scenario: Scenario, table: str, key: str) -> bool:
    """True if a world with vessels has a key of the scenario, and something that it acts on."""
    if key == "camera_noise_m" and adapted.physics.capture == "node":
        return False  # no vessel steers for an item, so that there is no camera
    if key == "item_classes":
        return adapted.physics.items == "bodies" or adapted.weather.forced  # else the paper's
    if key == "capture" and adapted.rules.capture == "calibrated":
        return True  # chances of the intake
    return bool(getattr(getattr(adapted, table), key) == getattr(getattr(scenario, table), key))


def _vessels(setup: Setup) -> dict[Vessel, list[str]]:
    """Every vessel as it moves -> the teams that have it."""
    choice: Physics = setup.scenario.physics
    found: dict[Vessel, list[str]] = {}
    for team, name in zip(setup.fleet.team, hull_names(setup.fleet, choice), strict=True):
        teams = found.setdefault(scaled(load_vessel(name), choice.scale), [])
        if (own := setup.fleet.team_names[team]) not in teams:
            teams.append(own)
    return found


def vessel_warnings(
    vessel: Vessel, wind_mps: float, step_s: float, remedy: str = "give physics.step_s of at most"
) -> Iterator[str]:
    """Lines about one vessel, whatever it is to do; none where all is well.

    Parameters
    ----------
    wind_mps : the most that blows
    step_s : of the integrator
    remedy : what to say before the longest step that the vessel's drag allows [s]
    """
    if wind_mps and not vessel.windage.any:
        yield f"has no [windage] and does not feel the wind of up to {wind_mps:.3g} m/s"
    yield from _too_quick(vessel, step_s, remedy)


def _of_vessel(
    scenario: Scenario, adapted: Iterable[Scenario], vessel: Vessel, teams: Iterable[str]
) -> Iterator[str]:
    wind = max(map(_most_wind_mps, adapted))
    if vessel.load == NO_LOAD and any(scenario.team[team].collects for team in teams):
        yield "has no [load], so that items aboard add neither mass nor drag"
    step_s = scenario.physics.step_s or (0.1 if scenario.physics.integrator == "fast" else 0.02)
    yield from vessel_warnings(vessel, wind, step_s)
    for team in teams:
        yield from _too_slow(scenario, vessel, team)


def _most_wind_mps(scenario: Scenario) -> float:
    weather = scenario.weather
    if weather.file is not None and (wind := read_record(weather.file).wind) is not None:
        return float(np.hypot(wind[..., 0], wind[..., 1]).max())
    if weather.wind_speed_mps is not None:
        return weather.wind_speed_mps * (1.0 + weather.wind_spread)
    most = math.hypot(*(max(map(abs, bounds)) for bounds in weather.drift_ranges))
    return most * scenario.map.pitch_m / scenario.period_s / LEEWAY


def _too_quick(vessel: Vessel, step_s: float, remedy: str) -> Iterator[str]:
    """Vessels whose control cannot keep up with them.

    Thrust that is wrong is mended after a period of control and the thrusters' lag. An integrator
    under a relay with such a dead time L swings by its slope times L, with a period of 4 L (Astrom
    and Hagglund, "PID Controllers", 1995, section 2.6, relay feedback): by all of its cruise speed,
    if full thrust gives that within L. In trials of a scout of 1 to 36 kg with lags of 0.2 to 3 s,
    positions at steps of 0.1 s and 0.02 s were 0.03 m to 0.15 m apart where it took longer, and up
    to 3.6 m where it did not.
    """
    reaction, rise = REACTION_S + vessel.lag_s, full_speed_s(vessel)
    if rise < reaction:
        yield (
            f"full thrust gives it its cruise speed in {rise:.2g} s, control and thruster lag take "
            f"{reaction:.2g} s: it hunts, and its ways hang on the time step; give a shorter "
            "lag_s, less thrust or more mass"
        )
    axis, rate = max(damping_rates(vessel).items(), key=lambda each: each[1])
    if rate * step_s > RK4_LIMIT:
        yield (
            f"drag takes its {axis} in {1.0 / rate:.2g} s, too short for a time step of "
            f"{step_s:g} s; {remedy} {RK4_LIMIT / rate:.2g} s"
        )


def _too_slow(scenario: Scenario, vessel: Vessel, team: str) -> Iterator[str]:
    """Teams whose vessels are late after a straight move, turning by 90 degrees for it."""
    moves, pitch = scenario.team[team].nodes, scenario.map.pitch_m
    needed = decision_s(vessel, moves * pitch)
    if needed > scenario.period_s:
        tuning = vessel_model(vessel).tuning
        yield (
            f"team.{team}.moves = {moves} of {pitch:g} m take it {needed:.3g} s, at "
            f"{tuning.cruise_ahead_mps:.3g} m/s after a turn of 90 degrees, and a decision has "
            f"{scenario.period_s:g} s: moves will be late; give fewer moves, a longer period_s or "
            "a shorter map.pitch_m"
        )
