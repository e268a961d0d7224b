"""What only a machine with a GPU can tell, in about five minutes: `python -m tests.gpu`.

Kernels against those of the processor, the speed of fleets and environments, and beside it MuJoCo
Warp's own humanoid on the same card.
"""

import subprocess
import sys
from pathlib import Path

import mujoco_warp

LIMIT_S = 200  # of each part
HUMANOID = Path(mujoco_warp.__file__).parent / "test_data" / "humanoid" / "humanoid.xml"
PARTS = {
    "kernels": ("-m", "tests.mjforage.physics.dynamics.repeated_on_device"),
    "fleets": ("-m", "mjforage", "bench", "--device", "cuda"),
    "humanoid": ("-m", "mujoco_warp.testspeed", str(HUMANOID), "--nworld=8192"),
}


def main() -> int:
    """Run all parts, one after the other; the number of those that failed."""
    failed = 0
    for name, part in PARTS.items():
        sys.stdout.write(f"== {name}\n")
        sys.stdout.flush()
        try:
            code = subprocess.run([sys.executable, *part], check=False, timeout=LIMIT_S).returncode
        except subprocess.TimeoutExpired:
            code = 1
            sys.stdout.write(f"stopped after {LIMIT_S} s\n")
        failed += code != 0
    return failed


if __name__ == "__main__":
    sys.exit(main())
