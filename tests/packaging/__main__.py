"""Check the wheel and the sdist in dist/, and use the wheel: `python -m tests.packaging`.

`python -m build` makes the wheel from the sdist, so that an sdist that cannot be built has no wheel
beside it. The wheel is installed into an environment of its own outside of the checkout. It shares
the libraries of the environment that runs this, which takes a minute less than to install them;
`tests/packaging/test_dependencies.py` checks that all that is imported is declared.
`--python python3.12` installs the declared dependencies for that interpreter instead.
"""

import argparse
import sys
import tempfile
from pathlib import Path

from tests.packaging.contents import REPOSITORY, sdist_faults, wheel_faults
from tests.packaging.trying import FailedError, try_editable, try_wheel


def main() -> None:
    """Exit with code 1 and what is wrong if something is."""
    parser = argparse.ArgumentParser(prog="python -m tests.packaging", description=__doc__)
    parser.add_argument("--python", metavar="FILE", help="interpreter of a complete environment")
    chosen = parser.parse_args()
    (wheel,), (sdist,) = ((REPOSITORY / "dist").glob(name) for name in ("*.whl", "*.tar.gz"))
    if faults := wheel_faults(wheel) + sdist_faults(sdist):
        sys.exit("\n".join(faults))
    with tempfile.TemporaryDirectory() as folder:
        try:
            try_wheel(wheel, Path(folder).resolve(), chosen.python)
            try_editable(Path(folder).resolve())
        except FailedError as error:
            sys.exit(f"dist: {error}")
    size = wheel.stat().st_size / 1e6
    sys.stdout.write(f"dist: {wheel.name}, {size:.2f} MB, and the sdist are whole and work\n")


if __name__ == "__main__":
    main()
