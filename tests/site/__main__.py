"""`python -m tests.site build/site`: what is wrong with a made site; exit code 1 if anything is."""

import sys
from pathlib import Path

from tests.site.checks import faults

site = Path(sys.argv[1]).resolve()
found = faults(site)
sys.stdout.write("".join(f"{line}\n" for line in found))
sys.exit(bool(found))
