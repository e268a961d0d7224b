"""The long runs behind the quick tests: `python -m tests.controllers.proving_ground`.

Straight legs, legs after a corner of 90 degrees, station keeping, and how fast vessels can turn.
"""

import sys

import numpy as np

from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Simulation
from mjforage.physics.vessel_models import vessel_model
from mjforage.physics.vessels import load_vessel
from tests.controllers.plant import (
    CONTROL_S,
    CORNER_M,
    Track,
    beam_gusts,
    cross_current,
    sail,
)
from tests.mjforage.mission.by_hand import CALM

WEATHERS = {
    "calm": CALM,
    "0.3 m/s current": cross_current(),
    "6 m/s gusts": beam_gusts(),
    "both": beam_gusts(current=True),
}


def say(*words: object) -> None:
    """Write a line."""
    sys.stdout.write(" ".join(str(word) for word in words) + "\n")


def leg_rmse(track: Track) -> float:
    """Worst cross-track RMSE of the episodes after the first 20 m of 100 m."""
    x, y = track.pose[..., 0], track.pose[..., 1]
    there = (x > 20.0) & (x < 99.5)
    return float(np.sqrt((y**2 * there).sum(axis=0) / there.sum(axis=0)).max())


def corner_rmse(track: Track, corner_m: float) -> float:
    """Worst cross-track RMSE of the episodes on the second leg, from 30 s after the corner."""
    x, y = track.pose[..., 0], track.pose[..., 1]
    turned = np.argmax(x > corner_m - CORNER_M, axis=0)
    after = np.arange(len(x))[:, None] > turned + round(30.0 / CONTROL_S)
    there = after & (np.abs(y) < 99.5)
    return float(np.sqrt((((x - corner_m) ** 2) * there).sum(axis=0) / there.sum(axis=0)).max())


def tracking(name: str) -> None:
    """Legs and station keeping of one vessel."""
    vessel, yaws = load_vessel(name), np.radians(np.arange(-180.0, 180.0, 15.0))
    for label, weather in WEATHERS.items():
        leg = sail(vessel, np.zeros(20), (100.0, 0.0), 100.0, weather=weather)
        around = sail(vessel, np.zeros(20), (40.0, 0.0), 110.0, weather=weather, then=(40.0, 100.0))
        kept = sail(vessel, yaws, (0.0, 0.0), 120.0, stay=True, weather=weather)
        rms = np.sqrt((kept.off((0.0, 0.0))[300:] ** 2).mean(axis=0))
        say(
            f"{name:8} {label:16} leg RMSE {leg_rmse(leg):.3f} m, "
            f"after a corner {corner_rmse(around, 40.0):.3f} m, keeping RMS {rms.max():.3f} m"
        )


def turning(name: str) -> None:
    """Half a turn from rest: equal thrusts ahead and astern, and all that the thrusters have."""
    vessel = load_vessel(name)
    low, high = vessel.thruster.command_range
    model = vessel_model(vessel)
    even = (model.k_astern / model.k_ahead) ** (1.0 / model.exponent) * -low
    for label, starboard in (("on the spot", min(even, high)), ("with all thrust", high)):
        simulation = Simulation(build_scene([vessel]))
        turned, before, ticks = 0.0, 0.0, 0
        while turned < np.pi:
            simulation.commands[0, 0] = low, starboard
            simulation.step()
            yaw = simulation.vessel_pose[0, 0, 2]
            turned += (yaw - before + np.pi) % (2.0 * np.pi) - np.pi
            before, ticks = yaw, ticks + 1
        aside = np.hypot(*simulation.vessel_pose[0, 0, :2])
        say(f"{name:8} 180 degrees {label}: {ticks * CONTROL_S:.1f} s, {aside:.1f} m off then")


def main() -> None:
    """Run everything and say it."""
    for name in ("scout", "forager"):
        tracking(name)
        turning(name)


if __name__ == "__main__":
    main()
