"""Look for seeds by which scenes show what they should: `python -m tests.mjforage.options`.

For every scene that does not, the first seed is printed by which it would, to be written into its
file. A scene of which nothing differs where something should, whatever the seed, tells of a fault.
"""

import sys
from dataclasses import replace
from itertools import chain

from tests.mjforage.options.scenes import Scene, differences, scenes

FILES = ("policies", "belief", "scenario", "physics")
SEEDS = 100


def shows(scene: Scene) -> bool:
    """Whether all that differs is what should."""
    return differences(scene) == set(scene.changes.split())


def main() -> None:
    """Print a line for every scene that needs another seed."""
    for scene in chain.from_iterable(map(scenes, FILES)):
        if shows(scene):
            continue
        found = (seed for seed in range(SEEDS) if shows(replace(scene, seed=seed)))
        seed = next(found, None)
        sys.stdout.write(f"{scene}: {'no seed' if seed is None else f'seed = {seed}'}\n")


if __name__ == "__main__":
    main()
