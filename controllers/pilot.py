"""The pilot of a batch of fleets: node moves in, thruster commands out, 10 times a second."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from controllers import state as at
from controllers._compiled import kernel
from controllers.chart import Chart, LandArray
from controllers.conflicts import Traffic
from controllers.estimate import estimate
from controllers.helm import FloatArray, Helm, packed
from controllers.prediction import NEVER_S, SAMPLES
from controllers.safety import limit_speeds
from controllers.state import CLOCK, HOLD, IDLE, MODE, RANK, START
from controllers.steering import change_mode, start_decision, steer
from controllers.traffic import plan_fleet, rank_fleet

OPEN_PITCH_M = 4.0  # side of a node where there is no chart
ROOM = 0.32  # of a node's side: farthest that midships goes from the centre to pick up
PLAN_S = 0.5  # between two looks at the traffic
HELD_MPS = 0.1  # slower than this at most counts as held back


@kernel
def _command(
    active: NDArray[np.bool_],
    pose: FloatArray,
    velocity: FloatArray,
    state: FloatArray,
    helms: FloatArray,
    land: LandArray,
    pitch: float,
    step_s: float,
    clock: NDArray[np.int64],
    paths: FloatArray,
    met: FloatArray,
    commands: FloatArray,
) -> None:
    room = ROOM * pitch
    rhythm = max(round(PLAN_S / step_s), 1)
    for e in range(active.size):
        commands[e] = 0.0
        if not active[e]:
            continue
        fleet = state[e]
        for v in range(helms.shape[0]):
            estimate(fleet[v], helms[v], pose[e, v], velocity[e, v], step_s)
            fleet[v, CLOCK] += step_s
        if fleet[0, MODE] == IDLE:
            continue
        if fleet[0, MODE] == START:
            clock[e] = 0
            for v in range(helms.shape[0]):
                start_decision(fleet[v], helms[v], room)
            rank_fleet(fleet, helms, paths[helms.shape[0]])
        for v in range(helms.shape[0]):
            change_mode(fleet[v], helms[v])
            if fleet[v, MODE] == HOLD and fleet[v, RANK] < NEVER_S:
                fleet[v, RANK] = NEVER_S + v  # who has arrived makes room
        if clock[e] % rhythm == 0 and helms.shape[0] > 1:
            plan_fleet(Traffic(fleet, helms, paths, met, land, pitch))
        clock[e] += 1
        for v in range(helms.shape[0]):
            limit_speeds(fleet, helms, land, pitch, v)
            port, starboard = steer(fleet[v], helms[v], room, step_s)
            commands[e, v, 0], commands[e, v, 1] = port, starboard


class Pilot:
    """Steers every vessel of every episode."""

    def __init__(
        self,
        helms: Sequence[Helm],
        chart: Chart | None,
        episodes: int,
        control_s: float = 0.1,
    ) -> None:
        """Take the helms.

        Parameters
        ----------
        helms : (vessel,) the fleet, the same in every episode
        chart : where quays are; None is open water
        episodes : size of the batch
        control_s : time between two calls of `command` [s]

        Raises
        ------
        ValueError
            If there is no vessel or no episode, or the time is not above 0.
        """
        if not helms or episodes < 1 or not 0.0 < control_s < np.inf:
            raise ValueError(
                f"pilot: {len(helms)} vessels, {episodes} episodes, control_s {control_s}; "
                "give at least one of each and seconds above 0"
            )
        self._helms = np.stack([packed(helm) for helm in helms])
        self._land = np.zeros((0, 0), np.bool_) if chart is None else chart.land
        self._pitch = OPEN_PITCH_M if chart is None else float(chart.pitch_m)
        self._step_s = float(control_s)
        self._state = np.zeros((episodes, len(helms), at.SIZE))
        self._clock = np.zeros(episodes, np.int64)
        self._paths = np.zeros((len(helms) + 1, SAMPLES, 4))
        self._met = np.zeros((len(helms), len(helms)))
        self._commands = np.zeros((episodes, len(helms), 2))
        self._every = np.arange(episodes)
        self.reset()

    def reset(self, ids: NDArray[Any] | None = None) -> None:
        """Forget episodes (indices or mask, all by default)."""
        chosen = self._every if ids is None else self._every[ids]
        self._state[chosen] = 0.0
        self._state[chosen, :, at.MODE] = at.IDLE
        self._state[chosen, :, at.ITEM_X : at.ITEM_Y + 1] = np.nan
        self._state[chosen, :, at.TARGET_X : at.TARGET_Y + 1] = np.nan

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
        rows = self._state[active]
        rows[..., at.ORIGIN_X : at.ORIGIN_Y + 1] = np.where(
            stay[active][..., None], target[active], origin[active]
        )
        rows[..., at.TARGET_X : at.TARGET_Y + 1] = target[active]
        rows[..., at.MODE], rows[..., at.ARRIVED] = at.START, 0.0
        self._state[active] = rows

    def collect(self, xy: FloatArray) -> None:
        """Name the item that each vessel shall pick up now.

        Parameters
        ----------
        xy : (episode, vessel, 2) [m]; NaN for none
        """
        self._state[..., at.ITEM_X : at.ITEM_Y + 1] = xy

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
        _command(
            np.ascontiguousarray(active, np.bool_),
            np.ascontiguousarray(pose, np.float64),
            np.ascontiguousarray(velocity, np.float64),
            self._state,
            self._helms,
            self._land,
            self._pitch,
            self._step_s,
            self._clock,
            self._paths,
            self._met,
            self._commands,
        )
        return self._commands

    @property
    def giving_way(self) -> NDArray[np.bool_]:
        """(episode, vessel) whether it is under way and held back for another hull or a quay."""
        state = self._state
        ahead, astern = state[..., at.MOST_AHEAD], state[..., at.MOST_ASTERN]
        most = np.where(state[..., at.WAY] > 0.0, ahead, astern)
        held = (state[..., at.WAIT] > state[..., at.CLOCK]) | (most < HELD_MPS)
        return np.asarray((state[..., at.MODE] == at.TRANSIT) & held)
