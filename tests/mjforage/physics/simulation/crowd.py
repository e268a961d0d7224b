"""Sixteen vessels among 300 items in a basin, wind on a corner; run here and by another MuJoCo.

`python crowd.py --beside PYTHON` runs it by that interpreter too, whose MuJoCo is another one, and
says how far positions are apart; exit code 1 if it is further than `TOLERANCE_M`.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.vessels import load_vessel

VESSELS, ITEMS = ("scout",) * 8 + ("forager",) * 8, 300
PITCH_M, STEP_S, WIND_MPS = 4.0, 0.1, (-6.0, -5.0)
TOLERANCE_M = 1e-7
"""How far anything may be apart at the end. Versions differ in the last bits of a sum, which
collisions double every 3 s or so: 1e-9 m were seen after 30 s, 9e-6 after 60. A fault of a solver
is metres."""
SECONDS = {Integrator.FAST: 30, Integrator.REFERENCE: 10}
"""The reference takes five times as long for the answers of the same solver."""


def crowd(integrator: Integrator) -> Simulation:
    """Vessels two metres apart, items among and under them, commands at random."""
    scene = build_scene(
        [load_vessel(name) for name in VESSELS],
        navigable=np.ones((12, 12), bool),
        pitch_m=PITCH_M,
        items=ITEMS,
    )
    rng = np.random.default_rng(1)
    simulation = Simulation(scene, 1, integrator=integrator, step_s=STEP_S, items=ITEMS)
    xy = np.stack(np.meshgrid(np.arange(4), np.arange(4)), axis=-1).reshape(-1, 2) * 2.2 + 8.0
    turns = rng.uniform(0.0, 2.0 * np.pi, (len(VESSELS), 1))
    simulation.place_vessels(np.concatenate((xy, turns), axis=1)[None])
    simulation.place_items(
        rng.uniform(6.0, 17.0, (1, ITEMS, 2)), rng.integers(0, len(scene.classes), (1, ITEMS))
    )
    simulation.vessel_wind[:] = simulation.item_wind[:] = WIND_MPS
    low, high = simulation.model.actuator_ctrlrange.T.reshape(2, -1, 2)
    share = rng.uniform(-0.3, 1.0, simulation.commands.shape)
    simulation.commands[:] = np.where(share > 0, share * high, -share * low)
    return simulation


def places(simulation: Simulation, seconds: int) -> NDArray[np.float64]:
    """(second, vessel and item, 2) positions, a simulation of the first [m]."""
    found = []
    for _ in range(seconds):
        simulation.step(round(1.0 / STEP_S))
        found.append(np.concatenate((simulation.vessel_pose[0, :, :2], simulation.item_xy[0])))
    return np.array(found)


def main() -> None:
    """Run the crowd, and beside another interpreter compare with what it finds."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--beside", metavar="PYTHON")
    parser.add_argument("--out", type=Path, metavar="FILE.npy")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "found.npy")
        if chosen.beside is not None:  # at the same time
            command = [chosen.beside, __file__, "--out", os.fspath(file)]
            other = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        found = np.concatenate([places(crowd(one), SECONDS[one]) for one in Integrator])
        if chosen.out is not None:
            np.save(chosen.out, found)
            sys.stdout.write(mujoco.__version__)
        if chosen.beside is None:
            return
        version, _ = other.communicate()
        assert other.returncode == 0
        apart = float(np.abs(np.load(file) - found).max())
    sys.stdout.write(
        f"{len(VESSELS)} vessels and {ITEMS} items, MuJoCo {mujoco.__version__} and {version}: "
        f"{apart:.1e} m apart after {SECONDS[Integrator.FAST]} s, {TOLERANCE_M:g} m are allowed\n"
    )
    sys.exit(not apart <= TOLERANCE_M)


if __name__ == "__main__":
    main()
