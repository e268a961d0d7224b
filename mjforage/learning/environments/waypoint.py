"""`mjforage/Waypoint-v0`: the thrusters of one vessel, to be steered to waypoints in weather."""

import math
from typing import Any, ClassVar, Unpack

import gymnasium
import numpy as np
from numpy.typing import NDArray

from mjforage.controllers import Pilot
from mjforage.learning.environments.checks import (
    RENDER_MODES,
    checked_options,
    checked_started,
    checked_thrusts,
)
from mjforage.learning.environments.waypoint_options import (
    REWARD as REWARD,
)
from mjforage.learning.environments.waypoint_options import (
    WaypointArguments,
    WaypointOptions,
)
from mjforage.learning.environments.waypoint_track import TICK_S, WaypointTrack
from mjforage.physics.vessel_models import vessel_model

TICKS = 5  # of 0.1 s in a step
WAYPOINTS = 8
HORIZON = 300  # steps of 0.5 s

SCALES = np.array(
    [20, 20, 4, 4, 20, 20, 3, 3, 1.5, 1, 1, 15, 15, 1, 1, 1], np.float64
)  # value at which an entry of the observation is 1; more is cut off

Numbers = NDArray[np.float32]


def observation_space() -> Any:
    """That of one environment, see `WaypointEnv`."""
    return gymnasium.spaces.Box(-1.0, 1.0, (SCALES.size,), np.float32)


def action_space() -> Any:
    """Thrust of port and starboard."""
    return gymnasium.spaces.Box(-1.0, 1.0, (2,), np.float32)


class WaypointEnv(gymnasium.Env[Numbers, Numbers]):
    """One vessel in MuJoCo on open water; a step is 0.5 s of constant commands.

    **Action** `Box(-1, 1, (2,))` float32: port and starboard, -1 full astern, 1 full ahead; cut off
    beyond, and refused where it is not finite.

    **Observation** `Box(-1, 1, (16,))` float32: each entry over its scale, cut off at -1 and 1:

    | entry | meaning | at 1 |
    |---|---|---|
    | 0, 1 | waypoint, forward and to port of midships | 20 m |
    | 2, 3 | the same, finer | 4 m |
    | 4, 5 | the waypoint after it | 20 m |
    | 6, 7 | surge and sway over ground | 3 m/s |
    | 8 | yaw rate | 1.5 rad/s |
    | 9, 10 | lagged commands of port and starboard | full ahead |
    | 11, 12 | wind over ground, forward and to port | 15 m/s |
    | 13, 14 | current, forward and to port | 1 m/s |
    | 15 | share of the time left | 1 |

    **Reward** named terms with weights, see `REWARD`; `info["reward/<term>"]` has each.
    `info` of steps and resets: `reached` (waypoints) and `distance_m` (to the present one).
    **End** terminated when all 8 waypoints, 4 to 12 m from one to the next, have been reached
    within 1 m; truncated after 150 s.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": RENDER_MODES, "render_fps": 2}  # type: ignore[misc]

    def __init__(self, **arguments: Unpack[WaypointArguments]) -> None:
        """Prepare; arguments are those of `WaypointOptions`.

        Raises `UserError` if an argument is not valid, or not known.
        """
        options = WaypointOptions.of(arguments)
        self.render_mode, self._weights = options.render_mode, options.weights
        self._track = WaypointTrack(options.hull, options.weather, options.spread, WAYPOINTS)
        self._low, self._high = self._track.vessel.thruster.command_range
        self._way: list[tuple[float, float]] = []  # empty until the first reset
        self.observation_space, self.action_space = observation_space(), action_space()

    @property
    def track(self) -> WaypointTrack:
        """The vessel and its waypoints."""
        return self._track

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Numbers, dict[str, Any]]:
        """Draw new waypoints and weather."""
        checked_options(options)
        super().reset(seed=seed)
        self._track.start(self.np_random)
        self._steps = 0
        self._way = []
        self._note()
        return self._observed(), self._facts()

    def step(self, action: Numbers) -> tuple[Numbers, float, bool, bool, dict[str, Any]]:
        """Half a second of constant commands.

        Returns: observation (16,), reward, terminated, truncated, `info`. Raises `UserError` if the
        action is not two finite numbers.

        Parameters
        ----------
        action : (2,) thrust of port and starboard, shares in [-1, 1]
        """
        checked_started(bool(self._way), "step")
        thrusts = checked_thrusts(action)
        port, starboard = (self._command(float(share)) for share in thrusts)
        gained, reached = 0.0, 0
        for _ in range(TICKS):
            if not self._track.over:
                gain, there = self._track.tick(port, starboard)
                gained, reached = gained + gain, reached + there
        effort = float(np.mean(np.square(thrusts)))
        return self._end_step({"progress": gained, "reached": reached, "effort": effort})

    def step_builtin(self, pilot: Pilot) -> tuple[Numbers, float, bool, bool, dict[str, Any]]:
        """Half a second under the built-in controller, which commands at 10 Hz.

        Parameters
        ----------
        pilot : of `builtin_pilot`
        """
        checked_started(bool(self._way), "step")
        gained, reached, effort = 0.0, 0, 0.0
        for _ in range(TICKS):
            if self._track.over:
                break
            track = self._track
            pose, velocity = track.pose[None, None], track.velocity[None, None]
            port, starboard = pilot.command(np.ones(1, np.bool_), pose, velocity)[0, 0]
            gain, there = track.tick(port, starboard)
            gained, reached = gained + gain, reached + there
            if there:
                self._order(pilot)
            shares = [self._share(float(port)), self._share(float(starboard))]
            effort += float(np.mean(np.square(shares))) / TICKS
        return self._end_step({"progress": gained, "reached": reached, "effort": effort})

    def builtin_pilot(self) -> Pilot:
        """The built-in controller of the vessel, with its orders for the present waypoint."""
        checked_started(bool(self._way), "builtin_pilot")
        pilot = Pilot([vessel_model(self._track.vessel)], None, 1, TICK_S)
        self._order(pilot)
        return pilot

    def _order(self, pilot: Pilot) -> None:
        track, nobody = self._track, np.zeros((1, 1), np.bool_)
        origin, target = track.pose[None, None, :2], track.target[None, None]
        pilot.order(np.ones(1, np.bool_), origin, target, nobody)

    def _end_step(
        self, amounts: dict[str, float]
    ) -> tuple[Numbers, float, bool, bool, dict[str, Any]]:
        self._steps += 1
        self._note()
        terms = {name: w * ({"time": 1.0} | amounts)[name] for name, w in self._weights.items()}
        info: dict[str, Any] = {f"reward/{name}": value for name, value in terms.items()}
        info |= self._facts()
        over = self._track.over
        late = self._steps >= HORIZON and not over
        return self._observed(), float(sum(terms.values())), over, late, info

    def _facts(self) -> dict[str, Any]:
        return {"reached": self._track.reached, "distance_m": self._track.distance_m}

    def _command(self, share: float) -> float:
        """Command [rad/s or N] of an action's entry."""
        return share * (self._high if share > 0.0 else -self._low)

    def _share(self, command: float) -> float:
        """The entry of an action that gives a command."""
        return command / (self._high if command > 0.0 else -self._low)

    def _observed(self) -> Numbers:
        track = self._track
        state = track.simulation.thruster_state[0, 0] / self._high
        values = np.concatenate(
            (
                *(self._ahead(track.target - track.pose[:2]),) * 2,
                self._ahead(track.following - track.pose[:2]),
                self._ahead(track.velocity[:2]),
                [track.velocity[2]],
                state,
                self._ahead(track.wind),
                self._ahead(track.current),
                [1.0 - self._steps / HORIZON],
            )
        )
        return np.clip(values / SCALES, -1.0, 1.0).astype(np.float32)

    def _ahead(self, vector: NDArray[np.float64]) -> NDArray[np.float64]:
        """A vector of the world as (forward, to port)."""
        c, s = math.cos(self._track.pose[2]), math.sin(self._track.pose[2])
        return np.array([c * vector[0] + s * vector[1], c * vector[1] - s * vector[0]])

    def _note(self) -> None:
        self._way.append((float(self._track.pose[0]), float(self._track.pose[1])))

    def render(self) -> Any:
        """Track, hull and waypoints from above, north up, (480, 480, 3) uint8; or None."""
        from mjforage.learning.environments.waypoint_figure import draw_track

        if self.render_mode is None:
            return None
        checked_started(bool(self._way), "render")
        return draw_track(self._track, self._way)
