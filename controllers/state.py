"""What a pilot remembers of one vessel: places in its row of numbers (SI units)."""

# Estimated pose; velocity over ground in world axes and yaw rate, as measured; number of fixes.
X, Y, YAW, VX, VY, RATE, KNOWN = range(7)
# Target and its origin; the leg being followed: start, end, course, length; 1 ahead or -1 astern.
TARGET_X, TARGET_Y, LEG_X, LEG_Y, END_X, END_Y, COURSE, LEG_LENGTH, WAY = range(7, 16)
# What it does (below); whether it has been at its target; whether the leg ends at a via point.
MODE, ARRIVED, VIA = range(16, 19)
# Line-of-sight integral [s]; drift with current and wind, world axes [m/s].
ACROSS_INTEGRAL, DRIFT_X, DRIFT_Y = range(19, 22)
# References of heading, yaw rate and speed; integrals of moment and surge force; heading wanted.
HEADING_REF, RATE_REF, SPEED_REF, MOMENT_INTEGRAL, SURGE_INTEGRAL, WANTED = range(22, 28)
# Force that keeping position has found, world axes [N].
HOLD_FX, HOLD_FY = range(28, 30)
# Fastest safe speed ahead and astern [m/s], and fastest safe turn [rad/s].
MOST_AHEAD, MOST_ASTERN, MOST_RATE = range(30, 33)
# Right of way: the lower goes first. Time of the decision to wait for. Item to pick up.
RANK, WAIT, ITEM_X, ITEM_Y = range(33, 37)
# Origin of the decision.
ORIGIN_X, ORIGIN_Y = range(37, 39)
# Modelled sway through the water [m/s]; commands that the thrusters' lag has let through.
SWAY, PORT, STARBOARD = range(39, 42)
# Seconds since the decision; where it keeps position: the target, or beside it to let others pass;
# 1 if no plan of its own is free of conflict; 1 if others already had to give it their way.
CLOCK, PLACE_X, PLACE_Y, STUCK, PROMOTED = range(42, 47)
# Modelled speed ahead through the water [m/s].
SURGE = 47
# 1 astern, -1 ahead: getting clear of the item to pick up.
BACKING = 48
# How far up the drift of its place it lies, where a quay is to leeward [m].
UP = 49
# How it picks up an item: 0 straight, 1 backing off, 2 along a quay, 3 backing off; for how long it
# has been still [s]; for how long it has been doing that [s].
APPROACH, STILL_S, APPROACH_S = range(50, 53)
SIZE = 53

# Modes; START: a decision not yet begun, IDLE: none yet.
HOLD, TRANSIT, START, IDLE = 0.0, 1.0, 2.0, 3.0
