"""Short missions with known answers: before the wind, in weather, by sensors, and at a quay."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import episode_keys
from mjforage.forcing import Forcing
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.mission.dynamics import BLOCKED, LATE, Transition
from mjforage.mission.moves import Moves
from mjforage.physics.dynamics.ticks import CONTROL_S
from mjforage.physics.hydrodynamics.conditions import Conditions
from mjforage.physics.mission_trial import UnsteeredDynamics, mission_measures
from mjforage.physics.vessel_checks import Float64Array
from mjforage.physics.vessels import Vessel, load_vessel
from mjforage.scenario.debris import load_debris
from mjforage.scenario.roles import Role
from mjforage.scenario.scenario import Items, MapChoice, Physics, Weather
from mjforage.scenario.sensors import Sensors
from tests.mjforage.mission.by_hand import by_hand
from tests.mjforage.physics.validation.measures import Measures, at_most, check, near, near_share
from tests.mjforage.physics.validation.momentum import MomentumVessel
from tests.mjforage.physics.validation.runs import VESSELS

FLEET, WATER, PITCH_M = ("scout", "forager"), (30, 40), 10.0
CLASSES = ("drifter", "bottle", "bag")
PLACES = np.array([(12.0 + 2.0 * k, 20.0 + 3.0 * (k % 2)) for k in range(8)])  # of items [node]
KEYS = episode_keys(3, np.arange(2))  # as many episodes as hulls
DECISIONS, PERIOD_S, WEATHER_S, FINE_S = 2, 10.0, 0.5, 0.02
BLOWN = Weather(
    noise_node_per_step=0.05,
    wind_speed_mps=6.0,
    wind_from_deg=200.0,
    gust_intensity=0.3,
    gust_tau_s=3.0,
    current_speed_mps=0.2,
    current_to_deg=290.0,
    current_wander_mps=0.2,
)
WEST = Weather(noise_node_per_step=0.0, wind_speed_mps=12.0, wind_from_deg=270.0)
QUAY, GAP_M = (15, 20), 1.5  # cell of land, and how far bows are from it at first
NOISE_M, NOISE_DEG, LATE_TICKS = 0.3, 2.0, 3  # of fixes, compass, and measurements


def begun(weather: Weather, **tables: Any) -> tuple[UnsteeredDynamics, Transition]:
    """A scout and a forager that no pilot steers, and items, on 300 x 400 m of water; their state.

    The quay is 100 m and more from where the hulls start.
    """
    role, water = Role(count=1, moves=1, radius=1.0, collects=False), np.ones(WATER, np.bool_)
    water[QUAY] = False
    own = {
        "map": MapChoice("sea", pitch_m=PITCH_M, starts=((5, 10), (5, 30))),
        "team": dict.fromkeys(FLEET, role),
        "items": Items(mean=len(PLACES), std=0.0),
        "physics": Physics(vessels={name: name for name in FLEET}, item_classes=CLASSES),
    }
    setup = by_hand(water, weather=weather, period_s=PERIOD_S, **(own | tables))
    dynamics = UnsteeredDynamics(setup.graph, setup.fleet, setup.scenario)
    initial, rc = setup.create_initial_state(KEYS), np.tile(PLACES, (len(KEYS), 1, 1))
    node = setup.graph.node_of_cell[tuple(np.moveaxis(rc.astype(int), -1, 0))]
    initial = replace(initial, item_rc=rc, item_node=node)
    return dynamics, dynamics.reset(initial, KEYS, ["0", "1"])


def advance(
    dynamics: UnsteeredDynamics, state: Transition, no_move: NDArray[np.bool_] | None = None
) -> Float64Array:
    """Send all hulls to where they started; (episode, hull) fastest impact [m/s]."""
    still, target = np.zeros(state.agent_node.shape, np.int8), state.agent_node.copy()
    impact, blocked = np.zeros(still.shape), still > 0 if no_move is None else no_move
    for step in range(1, DECISIONS + 1):
        moves = Moves(still + np.int8(STAY), target, still, blocked)
        dynamics.advance(np.ones(len(KEYS), np.bool_), np.full(len(KEYS), step, np.int32), moves)
        impact = np.maximum(impact, state.impact)
    return impact


@check("mission", "20a")
def mission() -> Measures:
    """Two hulls of every vessel that no pilot steers, before 10 m/s of wind, one of them laden.

    See `mjforage.physics.mission_trial`; `mjforage validate` has them too.
    """
    return [measure for name in VESSELS for measure in mission_measures(name)]


@check("mission-weather", "20b")
def mission_weather() -> Measures:
    """Hulls adrift and items in gusts and a current that wanders, two episodes for 20 s.

    Hulls against the momentum of vessel and water, items against
    m v' = a |W - v| (W - v) + b |c - v| (c - v), in the weather of their episode every 0.5 s.
    """
    dynamics, state = begun(BLOWN)
    metres, field = dynamics._graph.metres, field_of(dynamics)
    start = metres(state.agent_rc)
    classes = dynamics._simulation.item_class.astype(int)
    items = adrift(field, metres(state.item_rc), classes)
    advance(dynamics, state)
    off = np.linalg.norm(metres(state.item_rc) - items, axis=-1)
    found = [at_most("items, off place", off.max(), 0.02, "m")]
    for v, name in enumerate(FLEET):
        ends = np.column_stack((metres(state.agent_rc[:, v]), state.agent_yaw[:, v]))
        off = blown(field, load_vessel(name), start[:, v]) - ends
        found.append(at_most(f"{name}, off place and heading", np.abs(off).max(), 1e-3, "m, rad"))
    return found


def field_of(dynamics: UnsteeredDynamics) -> Forcing:
    """The weather of `BLOWN` for the episodes."""
    return Forcing.create(BLOWN, KEYS, dynamics._graph, PERIOD_S)


def times() -> list[float]:
    """Times at which the weather changes [s]."""
    return [WEATHER_S * k for k in range(round(DECISIONS * PERIOD_S / WEATHER_S))]


def adrift(field: Forcing, xy: Float64Array, classes: Any) -> Float64Array:
    """(episode, item, 2) where items from rest at `xy` come to [m], by the midpoint rule."""
    kinds, v = load_debris(), np.zeros_like(xy)
    table = np.array([(k.air, k.water, k.mass_kg + k.added_mass_kg) for k in kinds])
    air, water, mass = np.moveaxis(table[classes], -1, 0)[..., None]

    def gain(v: Float64Array, wind: Float64Array, flow: Float64Array) -> Float64Array:
        by_air, by_water = wind - v, flow - v
        sizes = (np.linalg.norm(past, axis=-1, keepdims=True) for past in (by_air, by_water))
        of_air, of_water = sizes
        return np.asarray((air * of_air * by_air + water * of_water * by_water) / mass)

    for t in times():
        flow = field.current(t, xy) + field.item_noise(t, xy.shape[1])
        about = field.wind(t, xy), flow
        for _ in range(round(WEATHER_S / FINE_S)):
            middle = v + 0.5 * FINE_S * gain(v, *about)
            xy, v = xy + FINE_S * middle, v + FINE_S * gain(middle, *about)
    return xy


def blown(field: Forcing, vessel: Vessel, start: Float64Array) -> Float64Array:
    """(episode, 3) pose of a vessel adrift from rest, heading east at first, by its momentum."""
    poses = []
    for e, (x, y) in enumerate(start.tolist()):
        yaw = u = v = r = 0.0
        for t in times():
            here = np.tile((x, y), (len(KEYS), 1, 1))
            (wx, wy), (cx, cy) = field.wind(t, here)[e, 0], field.current(t, here)[e, 0]
            hull = MomentumVessel(vessel, Conditions((cx, cy), (wx, wy), yaw, (u, v), r))
            hull.step(0.0, 0.0, WEATHER_S)
            dx, dy, yaw, u, v, r = hull.state()
            x, y = x + dx, y + dy
        poses.append((x, y, yaw))
    return np.array(poses)


@check("mission-sensors", "20c")
def mission_sensors() -> Measures:
    """What pilots are told in 20 s, less what is: white noise of its size; or less what was."""
    noisy = told(Sensors(position_noise_m=NOISE_M, heading_noise_deg=NOISE_DEG))
    late = Sensors(positioning="gnss", filter=False, latency_s=LATE_TICKS * CONTROL_S)
    shifted = np.abs(told(late, LATE_TICKS)).max()
    return [
        near_share("fix, deviation per axis", noisy[..., :2].std(), NOISE_M, 0.08, "m"),
        near_share("compass, deviation", np.degrees(noisy[..., 2].std()), NOISE_DEG, 0.1, "deg"),
        at_most("velocity, off the true one", np.abs(noisy[..., 3:]).max(), 0.0, "m/s, rad/s"),
        at_most("with a latency, off what was", shifted, 1e-9, "m, rad, m/s"),
    ]


def told(sensors: Sensors, late: int = 0) -> Float64Array:
    """(tick, episode, hull, 6) what pilots are told, less pose and velocity so many ticks ago."""
    dynamics, state = begun(BLOWN, sensors=sensors)
    ticks: Any = dynamics._playing
    given, true, inner = [], [], dynamics._pilot.command

    def command(active: Any, pose: Float64Array, velocity: Float64Array) -> Float64Array:
        given.append(np.concatenate((pose, velocity), axis=-1))
        true.append(np.concatenate(ticks.motion, axis=-1))
        return inner(active, pose, velocity)

    dynamics._pilot.command = command  # type: ignore[method-assign]
    advance(dynamics, state)
    off: Float64Array = np.array(given[late:]) - np.array(true[: len(true) - late])
    return off


@check("mission-watch", "20d")
def mission_watch() -> Measures:
    """Before 12 m/s of wind one hull of two comes to a quay, in each episode another one.

    It touches with the speed that wind and drag give it on the way there, and is blocked. The
    other one does not touch, and is late.
    """
    (dynamics, state), found = begun(WEST), []
    quay = dynamics._graph.metres(np.array(QUAY, np.float64)) - (0.5 * PITCH_M, 0.0)
    pose = np.zeros((len(KEYS), len(FLEET), 3))
    for e, name in enumerate(FLEET):
        pose[e, e, :2] = quay - (GAP_M + 0.5 * load_vessel(name).length_m, 0.0)
        pose[e, 1 - e, :2] = quay - (0.0, 50.0)
    dynamics.place(pose)
    impact = advance(dynamics, state)
    for e, name in enumerate(FLEET):
        speed, one, other = speed_after(load_vessel(name), GAP_M), (e, e), (e, 1 - e)
        found += [
            near_share(f"{name} at a quay: impact", impact[one], speed, 0.03, "m/s"),
            at_most("impact of the other", impact[other], 0.0, "m/s"),
            near("its touches", state.collisions[one], 1.0, 0.0),
            near("its outcome", state.outcome[one], BLOCKED, 0.0),
            near("touches of the other", state.collisions[other], 0.0, 0.0),
            near("outcome of the other", state.outcome[other], LATE, 0.0),
        ]
    return found


def speed_after(vessel: Vessel, way_m: float) -> float:
    """Speed [m/s] before the wind from rest after a way, by the midpoint rule."""
    x = u = 0.0
    wind, mass = vessel.windage, vessel.mass_kg + vessel.added_mass_surge_kg
    air = 0.5 * 1.224 * wind.area_front_m2 * wind.cdl_stern
    speed = WEST.wind_speed_mps or 0.0

    def gain(u: float) -> float:
        drag = vessel.linear_surge * u + vessel.quadratic_surge * u * u
        return (air * (speed - u) ** 2 - drag) / mass

    while x < way_m:
        middle = u + 0.5 * FINE_S * gain(u)
        x, u = x + FINE_S * middle, u + FINE_S * gain(middle)
    return u
