"""What only a machine with a GPU can tell, in 440 s at most: `python -m tests.gpu`.

Kernels, missions and rounds of training against those of the processor, the speed of fleets and
environments, and beside it MuJoCo Warp's own humanoid on the same card. Each figure is printed once
it is known.
"""

import subprocess
import sys
from pathlib import Path

import mujoco_warp

HUMANOID = Path(mujoco_warp.__file__).parent / "test_data" / "humanoid" / "humanoid.xml"
PARTS = {
    "speeds": (200, ("-m", "tests.gpu", "speeds")),
    "humanoid": (60, ("-m", "mujoco_warp.testspeed", str(HUMANOID), "--nworld=8192")),
    "missions": (90, ("-m", "tests.mjforage.physics.dynamics.simulated_mission")),
    "kernels": (90, ("-m", "tests.mjforage.physics.dynamics.repeated_on_device")),
}
"""Name -> seconds that it may take, and what it runs."""


def main() -> int:
    """Run all parts, one after the other; the number of those that failed."""
    failed = 0
    for name, (limit_s, part) in PARTS.items():
        sys.stdout.write(f"== {name}\n")
        sys.stdout.flush()
        try:
            code = subprocess.run([sys.executable, *part], check=False, timeout=limit_s).returncode
        except subprocess.TimeoutExpired:
            code = 1
            sys.stdout.write(f"stopped after {limit_s} s\n")
        failed += code != 0
    return failed


def speeds(device: str = "cuda") -> int:
    """Print each figure of the bench on a device as it comes; 0."""
    from mjforage.bench.on_device import speeds as measured

    for key, rate in measured(device):
        sys.stdout.write(f"{key} {rate.value:,.4g}, quickest {rate.quickest:,.4g}: {rate.unit}\n")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(speeds(*sys.argv[2:]) if sys.argv[1:2] == ["speeds"] else main())
