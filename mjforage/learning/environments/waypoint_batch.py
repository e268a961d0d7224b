"""Core of `Waypoint-v0` in batches: many vessels on a device, each with waypoints of its own.

The rules are those of `waypoint` and `waypoint_track`. Draws are counter-based, of an environment's
seed and the number of its episode, so that no environment depends on those beside it.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Call, Launch
from mjforage.base.randomness import Stream, UInt64Array, episode_key, stream_key, uniform
from mjforage.forcing.flow import OPEN_SEA
from mjforage.forcing.forcing import CURRENT, WIND
from mjforage.forcing.record import NO_RECORD
from mjforage.forcing.shelter import NO_SHELTER
from mjforage.forcing.steady import steady_vector
from mjforage.learning.environments.waypoint import HORIZON, REWARD, SCALES, TICKS, WAYPOINTS
from mjforage.learning.environments.waypoint_track import (
    FARTHEST_M,
    NEAREST_M,
    REACHED_M,
    TICK_S,
)
from mjforage.physics.callback.model_layout import LOSS, WATER
from mjforage.physics.device_hulls import DeviceHulls, Live
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation.integrators import Integrator, half_step_s
from mjforage.physics.vessels import Vessel
from mjforage.scenario.scenario import Spread, Weather

FloatArray = NDArray[np.float64]
Float32Array = NDArray[np.float32]
BoolArray = NDArray[np.bool_]
Int64Array = NDArray[np.int64]

TERMS = tuple(REWARD)
_MASS, _DRAG = LOSS + 2, LOSS + 3  # places in a vessel's surroundings
_SCALES = tuple(SCALES.tolist())


class Law(NamedTuple):
    """Numbers that all episodes have in common."""

    wind_mps: float
    wind_spread: float
    current_mps: float
    current_spread: float
    mass: float  # spreads, see `scenario.Spread`
    drag: float
    thrust: float
    low: float  # commands of full astern and ahead [rad/s] or [N]
    high: float
    shift_s: float  # by which Warp's places run ahead


class Tracks(NamedTuple):
    """The episodes, (env, ...) each."""

    seed: UInt64Array
    episode: Int64Array  # how many have begun
    waypoint: FloatArray  # (env, waypoint, 2) [m]
    reached: Int64Array
    steps: Int64Array
    clock_s: FloatArray
    mean_wind: FloatArray  # (env, 2) [m/s]
    mean_current: FloatArray
    gust_key: UInt64Array
    current_key: UInt64Array
    pose: FloatArray  # (env, 1, 3) x, y [m], yaw [rad]
    velocity: FloatArray  # (env, 1, 3) over ground
    lagged: FloatArray  # (env, 2) commands
    wind: FloatArray  # (env, 1, 2) at the vessel, over ground [m/s]
    current: FloatArray
    distance: FloatArray  # to the waypoint [m]


class Outcome(NamedTuple):
    """Results of a step, (env, ...) each."""

    observation: Float32Array  # (env, 16)
    terms: Float32Array  # (env, term) of the reward, weighted, in the order of `TERMS`
    reward: Float32Array
    terminated: BoolArray
    truncated: BoolArray
    over: BoolArray  # has ended and not begun anew
    reached: Int64Array  # before it begins anew, as `distance`
    distance: FloatArray


@kernel
def _distance(tracks: Tracks, e: int) -> float:
    """Distance to the waypoint that an episode is at [m]."""
    k = min(tracks.reached[e], WAYPOINTS - 1)
    dx = tracks.waypoint[e, k, 0] - tracks.pose[e, 0, 0]
    dy = tracks.waypoint[e, k, 1] - tracks.pose[e, 0, 1]
    return math.sqrt(dx * dx + dy * dy)


@kernel
def _begin(chosen: BoolArray, law: Law, tracks: Tracks, live: Live, outcome: Outcome) -> None:
    """Draw the next episodes of the chosen environments; vessels are at the origin, at rest."""
    for e in range(chosen.size):
        if not chosen[e]:
            continue
        key = episode_key(tracks.seed[e], tracks.episode[e])
        own, x, y = stream_key(key, Stream.WAYPOINTS), 0.0, 0.0
        for k in range(WAYPOINTS):
            reach = NEAREST_M + (FARTHEST_M - NEAREST_M) * uniform(own, k, 0)
            bearing = 2.0 * math.pi * uniform(own, k, 1)
            x, y = x + reach * math.cos(bearing), y + reach * math.sin(bearing)
            tracks.waypoint[e, k, 0], tracks.waypoint[e, k, 1] = x, y
        yaw = math.pi * (2.0 * uniform(own, 0, 2) - 1.0)
        wind = steady_vector(key, Stream.WEATHER, law.wind_mps, law.wind_spread, math.nan)
        current = steady_vector(key, Stream.CURRENT, law.current_mps, law.current_spread, math.nan)
        for axis in range(2):
            tracks.mean_wind[e, axis], tracks.mean_current[e, axis] = wind[axis], current[axis]
            tracks.lagged[e, axis] = 0.0
            live.lagged[e, axis] = live.commands[e, axis] = 0.0
        tracks.gust_key[e] = stream_key(key, Stream.GUSTS)
        tracks.current_key[e] = stream_key(key, Stream.CURRENT)
        for axis in range(3):
            live.places[e, axis] = live.velocities[e, axis] = 0.0
            tracks.pose[e, 0, axis] = tracks.velocity[e, 0, axis] = 0.0
        live.places[e, 2] = tracks.pose[e, 0, 2] = yaw
        vessel = stream_key(key, Stream.VESSELS)
        left = 1.0 + law.thrust * (2.0 * uniform(vessel, 0, 2) - 1.0)
        live.around[e, 0, LOSS] = live.around[e, 0, LOSS + 1] = left
        live.around[e, 0, _MASS] = 1.0 + law.mass * (2.0 * uniform(vessel, 0, 0) - 1.0)
        live.around[e, 0, _DRAG] = 1.0 + law.drag * (2.0 * uniform(vessel, 0, 1) - 1.0)
        tracks.episode[e] += 1
        tracks.reached[e] = tracks.steps[e] = 0
        tracks.clock_s[e] = 0.0
        tracks.distance[e] = _distance(tracks, e)
        outcome.over[e] = False


@kernel
def _command(actions: Float32Array, law: Law, live: Live, outcome: Outcome) -> None:
    """Take actions (env, 2), cut off at full thrust; effort is a term of the reward to be."""
    for e in range(actions.shape[0]):
        square = 0.0
        for side in range(2):
            share = min(max(float(actions[e, side]), -1.0), 1.0)
            live.commands[e, side] = share * (law.high if share > 0.0 else -law.low)
            square += share * share
        outcome.terms[e, 0] = outcome.terms[e, 1] = outcome.terms[e, 2] = 0.0
        outcome.terms[e, 3] = 0.5 * square


@kernel
def _mark(outcome: Outcome, again: BoolArray) -> None:
    """Those that are over begin anew in this step."""
    for e in range(again.size):
        again[e] = outcome.over[e]


@kernel
def _feel(tracks: Tracks, live: Live) -> None:
    """Give vessels the wind and the water of the moment."""
    for e in range(tracks.reached.size):
        for axis in range(2):
            live.around[e, 0, axis] = tracks.wind[e, 0, axis]
            live.around[e, 0, WATER + axis] = tracks.current[e, 0, axis]


@kernel
def _read(law: Law, tracks: Tracks, live: Live, outcome: Outcome) -> None:
    """Take what a tick has brought; vessels that have reached all waypoints stay as they were."""
    for e in range(tracks.reached.size):
        if tracks.reached[e] == WAYPOINTS:
            continue
        for axis in range(3):
            rate = float(live.velocities[e, axis])
            tracks.velocity[e, 0, axis] = rate
            tracks.pose[e, 0, axis] = live.places[e, axis] - law.shift_s * rate
        tracks.lagged[e, 0] = live.lagged[e, 0]
        tracks.lagged[e, 1] = live.lagged[e, 1]
        tracks.clock_s[e] += TICK_S
        before, now = tracks.distance[e], _distance(tracks, e)
        outcome.terms[e, 0] += before - now
        if now <= REACHED_M:
            outcome.terms[e, 1] += 1.0
            tracks.reached[e] += 1
        tracks.distance[e] = _distance(tracks, e)


@kernel
def _judge(weights: FloatArray, again: BoolArray, tracks: Tracks, outcome: Outcome) -> None:
    """Sum up a step; those that begin `again` have no reward, and have not ended."""
    for e in range(again.size):
        tracks.steps[e] += 1
        outcome.terms[e, 2] = 1.0
        outcome.reached[e], outcome.distance[e] = tracks.reached[e], tracks.distance[e]
        done = tracks.reached[e] == WAYPOINTS
        late = tracks.steps[e] >= HORIZON and not done
        outcome.terminated[e], outcome.truncated[e] = done and not again[e], late and not again[e]
        outcome.over[e] = (outcome.over[e] or done or late) and not again[e]
        total = 0.0
        for k in range(weights.size):
            value = 0.0 if again[e] else weights[k] * outcome.terms[e, k]
            outcome.terms[e, k] = value
            total += value
        outcome.reward[e] = total


@kernel
def _see(law: Law, tracks: Tracks, observation: Float32Array) -> None:
    """Write what environments show, see `WaypointEnv`."""
    for e in range(observation.shape[0]):
        c, s = math.cos(tracks.pose[e, 0, 2]), math.sin(tracks.pose[e, 0, 2])
        here, there = (
            min(tracks.reached[e], WAYPOINTS - 1),
            min(tracks.reached[e] + 1, WAYPOINTS - 1),
        )
        x, y = tracks.pose[e, 0, 0], tracks.pose[e, 0, 1]
        for pair in range(7):
            if pair < 2:
                u, v = tracks.waypoint[e, here, 0] - x, tracks.waypoint[e, here, 1] - y
            elif pair == 2:
                u, v = tracks.waypoint[e, there, 0] - x, tracks.waypoint[e, there, 1] - y
            elif pair == 3:
                u, v = tracks.velocity[e, 0, 0], tracks.velocity[e, 0, 1]
            elif pair == 5:
                u, v = tracks.wind[e, 0, 0], tracks.wind[e, 0, 1]
            else:
                u, v = tracks.current[e, 0, 0], tracks.current[e, 0, 1]
            at = 2 * pair + (pair > 3)
            observation[e, at], observation[e, at + 1] = c * u + s * v, c * v - s * u
        observation[e, 8] = tracks.velocity[e, 0, 2]
        observation[e, 9] = tracks.lagged[e, 0] / law.high
        observation[e, 10] = tracks.lagged[e, 1] / law.high
        observation[e, 15] = 1.0 - tracks.steps[e] / HORIZON
        for k in range(16):
            observation[e, k] = min(max(observation[e, k] / _SCALES[k], -1.0), 1.0)


BEGIN, COMMAND, MARK, FEEL = Launch(_begin), Launch(_command), Launch(_mark), Launch(_feel)
READ, SEE = Launch(_read), Launch(_see)
JUDGE = Launch(_judge, shared="weights")


class WaypointBatch:
    """Vessels of one kind on open water, their waypoints and the weather.

    Attributes
    ----------
    hulls : the vessels, and all arrays on the device
    tracks, outcome : of the host, see `DeviceHulls.arrays`
    actions : (env, 2) float32 thrust of port and starboard for the next step
    chosen : (env,) environments for the next `begin`
    last : (env, 16) float32 observations before new episodes began in the same step
    """

    def __init__(
        self,
        vessel: Vessel,
        weather: Weather,
        spread: Spread,
        weights: Mapping[str, float],
        envs: int,
        device: str,
        mode: AutoresetMode,
    ) -> None:
        """Set up the vessels; no episode has begun.

        Raises `UserError` if there is no such device.

        Parameters
        ----------
        weather : speeds of wind and current, their spreads, and gusts
        spread : of the vessel's numbers from one episode to the next
        weights : term -> weight, see `REWARD`
        device : "warp-cpu" or "cuda"
        mode : when environments that are over begin anew
        """
        self.hulls = hulls = DeviceHulls(build_scene([vessel]), envs, step_s=TICK_S, device=device)
        low, high = vessel.thruster.command_range
        winds = weather.wind_speed_mps or 0.0, weather.wind_spread
        currents = weather.current_speed_mps, weather.current_spread
        shift_s = half_step_s(Integrator.FAST, TICK_S)
        law = Law(*winds, *currents, spread.mass, spread.drag, spread.thrust, low, high, shift_s)
        self.tracks = tracks = _tracks(envs)
        self.outcome = outcome = _outcome(envs)
        self.actions, self.last = np.zeros((envs, 2), np.float32), np.zeros((envs, 16), np.float32)
        self.chosen, again = np.zeros(envs, np.bool_), np.zeros(envs, np.bool_)
        given = np.array([weights.get(term, 0.0) for term in TERMS])
        gusts = weather.gust_intensity or 0.0, weather.gust_tau_s
        at_sea = OPEN_SEA.patches, OPEN_SEA.spacing_m, OPEN_SEA.corner_m
        blown = tracks.mean_wind, tracks.gust_key, *gusts, NO_SHELTER, NO_RECORD
        flowing = tracks.mean_current, tracks.current_key, 0.0, 0.0, *at_sea, NO_RECORD
        blow = hulls.bind(WIND, *blown, tracks.clock_s, tracks.pose, tracks.wind)
        flow = hulls.bind(CURRENT, *flowing, tracks.clock_s, tracks.pose, tracks.current)
        see = hulls.bind(SEE, law, tracks, outcome.observation)

        def begin(those: BoolArray) -> tuple[Call, ...]:
            return hulls.bind(BEGIN, those, law, tracks, hulls.live, outcome), blow, flow, see

        tick = (
            hulls.bind(FEEL, tracks, hulls.live),
            hulls.step,
            hulls.bind(READ, law, tracks, hulls.live, outcome),
            blow,
        )
        command = hulls.bind(COMMAND, self.actions, law, hulls.live, outcome)
        judge = hulls.bind(JUDGE, given, again, tracks, outcome)
        self._begin, step = begin(self.chosen), (command, *tick * TICKS, judge)
        self._step = {
            AutoresetMode.NEXT_STEP: (hulls.bind(MARK, outcome, again), *step, *begin(again)),
            AutoresetMode.SAME_STEP: (
                *step,
                hulls.bind(SEE, law, tracks, self.last),
                *begin(outcome.over),
            ),
            AutoresetMode.DISABLED: (*step, see),
        }[mode]

    def begin(self) -> None:
        """Begin the next episodes of the chosen environments."""
        with self.hulls.beside_torch():
            self.hulls.run(self._begin)

    def step(self) -> None:
        """Half a second of constant commands in all environments."""
        with self.hulls.beside_torch():
            self.hulls.run(self._step)


def _tracks(envs: int) -> Tracks:
    """All zero."""
    one, pair, place = (), (2,), (1, 3)
    wide: dict[str, tuple[int, ...]] = {
        "waypoint": (WAYPOINTS, 2),
        "pose": place,
        "velocity": place,
    }
    wide |= {"mean_wind": pair, "mean_current": pair, "lagged": pair}
    wide |= {"wind": (1, 2), "current": (1, 2)}
    whole: dict[str, type] = dict.fromkeys(("seed", "gust_key", "current_key"), np.uint64)
    whole |= dict.fromkeys(("episode", "reached", "steps"), np.int64)
    arrays: dict[str, NDArray[Any]] = {
        name: np.zeros((envs, *wide.get(name, one)), whole.get(name, np.float64))
        for name in Tracks._fields
    }
    return Tracks(**arrays)


def _outcome(envs: int) -> Outcome:
    numbers = [np.zeros((envs, *more), np.float32) for more in ((SCALES.size,), (len(TERMS),), ())]
    rest = [np.zeros(envs, kind) for kind in (*(np.bool_,) * 3, np.int64, np.float64)]
    return Outcome(*numbers, *rest)
