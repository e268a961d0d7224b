"""Are the wheel and the sdist in dist/ whole, and does the wheel work? `python -m tests.packaging`.

`python -m build` makes the wheel from the sdist, so that a sdist that cannot be built has no wheel
beside it. The wheel is installed into an environment of its own outside of the checkout. It shares
the libraries of the environment that runs this, which takes a minute less than to install them;
`tests/packaging/test_dependencies.py` sees to it that all that is imported is declared.
`--python python3.12` installs the declared dependencies for that interpreter instead.
"""

import argparse
import sys
import tempfile
from pathlib import Path

from tests.packaging.contents import REPOSITORY, sdist_faults, tracked, wheel_faults
from tests.packaging.trying import FailedError, try_wheel


def main() -> None:
    """Check what lies in dist/; exit code 1 and what is wrong if something is."""
    parser = argparse.ArgumentParser(prog="python -m tests.packaging", description=__doc__)
    parser.add_argument("--python", metavar="FILE", help="interpreter of a complete environment")
    parser.add_argument("--dist", type=Path, default=REPOSITORY / "dist", metavar="DIR")
    chosen = parser.parse_args()
    dist = chosen.dist.resolve()
    wheels, sdists = sorted(dist.glob("*.whl")), sorted(dist.glob("*.tar.gz"))
    if (len(wheels), len(sdists)) != (1, 1):
        sys.exit(f"dist: one wheel and one sdist are expected in {dist}; `make dist` makes them")
    files = tracked()
    if faults := wheel_faults(wheels[0], files) + sdist_faults(sdists[0], files):
        sys.exit("\n".join(faults))
    with tempfile.TemporaryDirectory() as folder:
        try:
            try_wheel(wheels[0], Path(folder).resolve(), chosen.python)
        except FailedError as error:
            sys.exit(f"dist: {error}")
    size = wheels[0].stat().st_size / 1e6
    sys.stdout.write(f"dist: {wheels[0].name}, {size:.2f} MB, and the sdist are whole and work\n")


if __name__ == "__main__":
    main()
