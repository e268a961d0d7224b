"""A pilot's memory of one vessel: a record of floats, SI units, world axes."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mjforage.controllers.records import record_type


class VesselState:
    """The fields of the record `STATE`, for readers and type checkers; it is never made."""

    # Estimated pose of midships, as measured velocity over ground and yaw rate; number of fixes.
    x: float
    y: float
    yaw: float
    vx: float
    vy: float
    rate: float
    known: float
    # Target of the decision; the leg being followed; the way along it: 1 ahead or -1 astern.
    target_x: float
    target_y: float
    leg_x: float
    leg_y: float
    end_x: float
    end_y: float
    course: float
    leg_length: float
    way: float
    # What it does (one of the modes below); 1 once it has been at its target; 1 if the leg ends at
    # a via point.
    mode: float
    arrived: float
    via: float
    # Line-of-sight integral [s]; drift with current and wind [m/s].
    across_integral: float
    drift_x: float
    drift_y: float
    # References of heading, yaw rate and speed; integrals of moment and surge force; heading
    # wanted.
    heading_ref: float
    rate_ref: float
    speed_ref: float
    moment_integral: float
    surge_integral: float
    wanted: float
    # Force that keeping position has found [N].
    hold_fx: float
    hold_fy: float
    # Fastest safe speed ahead and astern [m/s], and fastest safe turn to port and starboard
    # [rad/s].
    most_ahead: float
    most_astern: float
    most_port: float
    most_starboard: float
    # 1 where it leans on a quay or a vessel; moments to port and starboard with which it turns off
    # against the water [N m].
    in_contact: float
    load_port: float
    load_starboard: float
    # Way to the land that its drift carries it to first, 0 if none is near [m].
    lee_x: float
    lee_y: float
    # Right of way: the lower goes first. Time of the decision to wait for.
    rank: float
    wait: float
    # Item to pick up and the one to be ready for after it, NaN for none; 1 to look round for one;
    # where the decision began.
    item_x: float
    item_y: float
    next_x: float
    next_y: float
    looks: float
    origin_x: float
    origin_y: float
    # Modelled sway through the water [m/s]; commands that the thrusters' lag has let through.
    sway: float
    port: float
    starboard: float
    # Seconds since the decision; where it keeps position: the target, or beside it to let others
    # pass.
    clock: float
    place_x: float
    place_y: float
    # 1 if no plan of its own is free of conflict; 1 if others already had to give it their way.
    stuck: float
    promoted: float
    # Modelled speed ahead through the water [m/s].
    surge: float
    # Getting clear of the item to pick up: 1 astern, -1 ahead, else 0.
    backing: float
    # How far up the drift of its place it lies, where a quay is to leeward [m].
    up: float
    # Quays beside the item, east or west and north or south of it: 1, -1 or 0 for none;
    # beside a quay, the course on which the mouth is brought to it [rad].
    quay_x: float
    quay_y: float
    run: float
    # Whether it backs off from it (see `quayside`); for how long it has been still [s].
    approach: float
    still_s: float
    # What its position may be off [m], see `navigation`.
    margin: float
    # Where it was when quays began to hold it, and for how long they have [s]; the course on which
    # it gets off, ahead (1) or astern (-1), and the time left for that [s] (see `getting_off`).
    was_x: float
    was_y: float
    held_s: float
    off_heading: float
    off_way: float
    off_s: float
    # Share of its thrust that each thruster has lost, as noticed, 0 below a threshold, below 1.
    port_loss: float
    starboard_loss: float
    # What the filter of `effectiveness` keeps: estimated losses and bias, and their covariance;
    # smooth rate of turn, speed ahead, unexplained moment and force, and thrusts; time since a
    # contact.
    port_off: float
    starboard_off: float
    bias: float
    port_var: float
    starboard_var: float
    bias_var: float
    cross_var: float
    port_bias_var: float
    starboard_bias_var: float
    slow_rate: float
    slow_surge: float
    slow_moment: float
    slow_force: float
    slow_port: float
    slow_starboard: float
    free_s: float


STATE = record_type(VesselState.__annotations__)
FleetArray: TypeAlias = NDArray[Any]  # (vessel,) or (episode, vessel) of `STATE`

# Modes; START: a decision not yet begun, IDLE: none yet.
HOLD, TRANSIT, START, IDLE = 0.0, 1.0, 2.0, 3.0


def idle_state() -> VesselState:
    """The state of a vessel that has no decision yet."""
    state: VesselState = np.zeros(1, STATE)[0]
    state.mode = IDLE
    state.item_x = state.item_y = state.next_x = state.next_y = np.nan
    state.target_x = state.target_y = np.nan
    return state
