"""The pilot of a batch of fleets: node moves in, thruster commands out, 10 times a second."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.controllers.chart import OPEN_WATER, Chart, LandArray
from mjforage.controllers.conflicts import Traffic
from mjforage.controllers.effectiveness import notice_losses, weaken_fleet
from mjforage.controllers.estimate import estimate
from mjforage.controllers.getting_off import note_held
from mjforage.controllers.navigation import NAVIGATE, Navigator, SensorErrors
from mjforage.controllers.prediction import NEVER_S, SAMPLES
from mjforage.controllers.quayside import note_quays
from mjforage.controllers.safety import limit_speeds
from mjforage.controllers.state import HOLD, IDLE, START, STATE, TRANSIT, FleetArray, idle_state
from mjforage.controllers.steering import change_mode, start_decision, steer
from mjforage.controllers.traffic import plan_fleet, rank_fleet
from mjforage.controllers.vessel_model import MODEL, FloatArray, ModelArray, VesselModel, packed

OPEN_PITCH_M = 4.0  # side of a node where there is no chart
ROOM = 0.32  # of a node's side: farthest that midships goes from the centre to pick up
PLAN_S = 0.5  # between two plans of the traffic
LIMITED_MPS = 0.1  # slower than this at most counts as held back
BoolArray = NDArray[np.bool_]


class FleetArrays(NamedTuple):
    """A batch of fleets and their knowledge of each other, written by the pilot."""

    state: FleetArray  # (episode, vessel)
    models: ModelArray  # (vessel,)
    weak: ModelArray  # (vessel,) the same, as weak as the vessels of an episode are
    land: LandArray  # of a `Chart`
    pitch: float  # [m]
    ticks: NDArray[np.int64]  # (episode,) since the decision
    paths: FloatArray  # (vessel + 1, SAMPLES, 4), see `Traffic`
    met: FloatArray  # (vessel, vessel), see `Traffic`
    notices: bool  # whether lost thrust is looked for


@kernel
def _begin(fleet: FleetArray, models: ModelArray, room: float, spare: FloatArray) -> None:
    """Let every vessel of an episode set out for its new decision, and rank them."""
    for v in range(models.shape[0]):
        start_decision(fleet[v], models[v], room)
    rank_fleet(fleet, models, spare)


@kernel
def _steer_fleet(fleets: FleetArrays, e: int, step_s: float, commands: FloatArray) -> None:
    """One tick of episode `e` under way: change modes, plan at times, command every vessel."""
    fleet, models, room = fleets.state[e], fleets.models, ROOM * fleets.pitch
    if fleets.notices:
        weaken_fleet(fleet, models, fleets.weak)
        models = fleets.weak
    if fleet[0].mode == START:
        fleets.ticks[e] = 0
        _begin(fleet, models, room, fleets.paths[models.shape[0]])
    for v in range(models.shape[0]):
        change_mode(fleet[v], models[v])
        if fleet[v].mode == HOLD and fleet[v].rank < NEVER_S:
            fleet[v].rank = NEVER_S + v  # one that has arrived makes room
    if fleets.ticks[e] % max(round(PLAN_S / step_s), 1) == 0 and models.shape[0] > 1:
        plan_fleet(Traffic(fleet, models, fleets.paths, fleets.met, fleets.land, fleets.pitch))
    fleets.ticks[e] += 1
    for v in range(models.shape[0]):
        note_quays(fleet[v], models[v], fleets.land, fleets.pitch)
        limit_speeds(fleet, models, fleets.land, fleets.pitch, v)
        note_held(fleet, models, fleets.land, fleets.pitch, v, step_s)
        port, starboard = steer(fleet[v], models[v], room, step_s)
        commands[e, v, 0], commands[e, v, 1] = port, starboard


@kernel
def _command(
    fleets: FleetArrays,
    step_s: float,
    commands: FloatArray,
    active: NDArray[np.bool_],
    pose: FloatArray,
    velocity: FloatArray,
) -> None:
    """Measure and command every vessel of the active episodes; 0 for all others."""
    state, models = fleets.state, fleets.models
    for e in range(active.size):
        commands[e] = 0.0
        if not active[e]:
            continue
        for v in range(models.shape[0]):
            estimate(state[e, v], models[v], pose[e, v], velocity[e, v], step_s)
            state[e, v].clock += step_s
            if fleets.notices:
                notice_losses(state[e, v], models[v], step_s)
        if state[e, 0].mode != IDLE:
            _steer_fleet(fleets, e, step_s, commands)
            continue
        for v in range(models.shape[0]):  # what it leans on is not to be taken for the water
            limit_speeds(state[e], models, fleets.land, fleets.pitch, v)


@kernel
def _giving_way(state: FleetArray, held: NDArray[np.bool_]) -> None:
    """Write (episode, vessel) `Pilot.giving_way`."""
    for e in range(state.shape[0]):
        for v in range(state.shape[1]):
            s = state[e, v]
            most = s.most_ahead if s.way > 0.0 else s.most_astern
            held[e, v] = s.mode == TRANSIT and (s.wait > s.clock or most < LIMITED_MPS)


@kernel
def _tell(state: FleetArray, item: FloatArray, following: FloatArray, look: BoolArray) -> None:
    """Name the items to collect and to be ready for, (episode, vessel, 2), and who looks round."""
    for e in range(state.shape[0]):
        for v in range(state.shape[1]):
            s = state[e, v]
            s.item_x, s.item_y = item[e, v, 0], item[e, v, 1]
            s.next_x, s.next_y = following[e, v, 0], following[e, v, 1]
            s.looks = 1.0 if look[e, v] else 0.0


@kernel
def _order(
    state: FleetArray,
    active: BoolArray,
    origin: FloatArray,
    target: FloatArray,
    stay: BoolArray,
) -> None:
    """Give the decisions of one period, see `Pilot.order`."""
    for e in range(active.size):
        if not active[e]:
            continue
        for v in range(state.shape[1]):
            s, begin = state[e, v], target[e, v] if stay[e, v] else origin[e, v]
            s.origin_x, s.origin_y = begin[0], begin[1]
            s.target_x, s.target_y = target[e, v, 0], target[e, v, 1]
            s.mode, s.arrived = START, 0.0


COMMAND = Launch(_command, shared="models land", memory="weak paths met")
ORDER = Launch(_order)
GIVING_WAY, TELL = Launch(_giving_way), Launch(_tell)


class Pilot:
    """Steers every vessel of every episode."""

    def __init__(
        self,
        models: Sequence[VesselModel],
        chart: Chart | None,
        episodes: int,
        control_s: float = 0.1,
        errors: SensorErrors | None = None,
        *,
        notices: bool = False,
    ) -> None:
        """Take the models.

        Parameters
        ----------
        models : (vessel,) the fleet, the same in every episode
        chart : quays; None is open water
        episodes : size of the batch
        control_s : time between two calls of `command` [s]
        errors : of the sensors, for a filter; None for dead reckoning drawn to the fixes
        notices : whether thrust that is lost is looked for and steered with
        """
        count = len(models)
        self._step_s = float(control_s)
        self._fleets = FleetArrays(
            state=np.zeros((episodes, count), STATE),
            models=np.array([packed(model) for model in models], MODEL),
            weak=np.zeros(count, MODEL),
            land=OPEN_WATER if chart is None else chart.land,
            pitch=OPEN_PITCH_M if chart is None else float(chart.pitch_m),
            ticks=np.zeros(episodes, np.int64),
            paths=np.zeros((count + 1, SAMPLES, 4)),
            met=np.zeros((count, count)),
            notices=notices,
        )
        self._navigator = None
        if errors is not None:
            self._fleets.models["filter_s"] = 0.0  # what is filtered is taken as it is
            self._navigator = Navigator(errors, self._fleets.models, self._fleets.state)
        self._commands = np.zeros((episodes, count, 2))
        self._command = BoundKernel(_command, self._fleets, self._step_s, self._commands)
        self._giving_way = BoundKernel(_giving_way, self._fleets.state)
        self.reset()

    def reset(self, ids: NDArray[Any] | None = None) -> None:
        """Forget episodes (indices or mask, all by default)."""
        which = slice(None) if ids is None else ids
        self._fleets.state[which] = idle_state()
        self._fleets.ticks[which], self._commands[which] = 0, 0.0
        if self._navigator is not None:
            self._navigator.reset(which)

    def order(
        self,
        active: NDArray[np.bool_],
        origin: FloatArray,
        target: FloatArray,
        stay: NDArray[np.bool_],
    ) -> None:
        """Give the decisions of one period.

        Parameters
        ----------
        active : (episode,) others keep what they had
        origin, target : (episode, vessel, 2) centres of the nodes from and to [m]
        stay : (episode, vessel) whether to keep position at the target
        """
        _order(self._fleets.state, active, origin, target, stay)

    def collect(self, xy: FloatArray) -> None:
        """Set the item that each vessel shall collect now.

        Parameters
        ----------
        xy : (episode, vessel, 2) [m]; NaN for none
        """
        self._fleets.state["item_x"], self._fleets.state["item_y"] = xy[..., 0], xy[..., 1]

    def expect(self, xy: FloatArray) -> None:
        """Name the item that each vessel shall be ready for when it has nothing left to do.

        Parameters
        ----------
        xy : (episode, vessel, 2) [m]; NaN for none
        """
        self._fleets.state["next_x"], self._fleets.state["next_y"] = xy[..., 0], xy[..., 1]

    def look_round(self, which: NDArray[np.bool_]) -> None:
        """Let some vessels (episode, vessel) turn on the spot where they keep position."""
        self._fleets.state["looks"] = which

    def locate(
        self,
        active: NDArray[np.bool_],
        pose: FloatArray,
        velocity: FloatArray,
        fix: NDArray[np.bool_],
    ) -> tuple[FloatArray, FloatArray]:
        """Poses and velocities for `command`: estimated from measurements, or those themselves.

        Parameters
        ----------
        active : (episode,) others keep what they had
        pose, velocity : as of `command`, measured
        fix : (episode, vessel) whether the position is of a new fix
        """
        if self._navigator is None:
            return pose, velocity
        told = self._navigator.update(active, pose, velocity, fix)
        return told.pose, told.velocity

    def command(
        self, active: NDArray[np.bool_], pose: FloatArray, velocity: FloatArray
    ) -> FloatArray:
        """Commands for the next `control_s` seconds.

        Parameters
        ----------
        active : (episode,) others get 0
        pose : (episode, vessel, 3) measured x, y [m], yaw [rad] of midships
        velocity : (episode, vessel, 3) over ground, world axes [m/s], [rad/s]

        Returns
        -------
        (episode, vessel, 2) port, starboard, in the thruster's unit and range, 0 before the first
        order; valid until the next call
        """
        self._command(
            np.ascontiguousarray(active, np.bool_),
            np.ascontiguousarray(pose, np.float64),
            np.ascontiguousarray(velocity, np.float64),
        )
        return self._commands

    @property
    def arrays(self) -> tuple[FleetArray, NDArray[np.int64]]:
        """Its memory, for a device that has it as well."""
        return self._fleets.state, self._fleets.ticks

    def locating(
        self, bind: Bind, active: BoolArray, pose: FloatArray, velocity: FloatArray, fix: BoolArray
    ) -> tuple[tuple[Call, ...], FloatArray, FloatArray]:
        """`locate` by a kernel on a device: calls, and the poses and velocities that they write."""
        if self._navigator is None:
            return (), pose, velocity
        told, about = self._navigator.filters, self._navigator.fixed
        return (bind(NAVIGATE, *about, active, pose, velocity, fix),), told.pose, told.velocity

    def commanding(
        self,
        bind: Bind,
        active: BoolArray,
        pose: FloatArray,
        velocity: FloatArray,
        commands: FloatArray,
    ) -> Call:
        """`command` by a kernel on a device, which writes `commands` (episode, vessel, 2)."""
        return bind(COMMAND, self._fleets, self._step_s, commands, active, pose, velocity)

    def ordering(
        self,
        bind: Bind,
        active: BoolArray,
        origin: FloatArray,
        target: FloatArray,
        stay: BoolArray,
    ) -> Call:
        """`order` by a kernel on a device."""
        return bind(ORDER, self._fleets.state, active, origin, target, stay)

    def telling(self, bind: Bind, item: FloatArray, following: FloatArray, look: BoolArray) -> Call:
        """`collect`, `expect` and `look_round` by a kernel on a device."""
        return bind(TELL, self._fleets.state, item, following, look)

    def yielding(self, bind: Bind, held: BoolArray) -> Call:
        """`giving_way` by a kernel on a device, which writes `held` (episode, vessel)."""
        return bind(GIVING_WAY, self._fleets.state, held)

    @property
    def giving_way(self) -> NDArray[np.bool_]:
        """(episode, vessel) whether it is under way and held back for another vessel or a quay."""
        held = np.empty(self._fleets.state.shape, np.bool_)
        self._giving_way(held)
        return held
