"""Install the wheel and the checkout into environments of their own, and use them elsewhere."""

import os
import subprocess
import sys
import sysconfig
import venv
from collections.abc import Sequence
from pathlib import Path

from tests.packaging.contents import REPOSITORY

USES = (
    "mjforage --help",
    "mjforage evaluate comb-port --policy greedy --episodes 2 --out run",
    "mjforage report run",
    "mjforage compare comb-port --policy levy --episodes 1 --out both",
    "mjforage render run -o run.png",
    "mjforage maps harbour:combs:7 -o harbour.png",
    "mjforage schemas --out schemas",
    "python -m mjforage policies",
    "python all_modules.py",
)
"""Commands, each after those before it."""

MADE = ("run/report.html", "both/report.html", "run.png", "harbour.png", "schemas/scenario.json")

USERS_OWN = (
    *("metrics.py", "controllers/__init__.py", "graph_planner/__init__.py"),
    *("tests/__init__.py", "models/__init__.py"),
)
"""Modules that a user may have beside a script; importing any of them ends the process."""

EXTRAS = (
    *("av", "distributed", "stable_baselines3", "tensorboard", "tensordict", "torch"),
    *("torchrl", "pyogrio", "pyproj", "shapely", "mcap", "mcap_ros2", "foxglove", "xarray"),
    *("warp", "mujoco_warp"),
)
"""Modules that an installation without extras lacks."""

WITHOUT = f"""
import sys

class WithoutExtras:
    @staticmethod
    def find_spec(name, path=None, target=None):
        if name in {EXTRAS}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, WithoutExtras)
"""
"""A module: extras are not to be found after its import, whatever is installed."""

ALL_MODULES = f"""
import importlib, importlib.metadata, pkgutil, sys
import gymnasium
import mjforage
assert mjforage.__file__.startswith(sys.prefix), f"mjforage comes from {{mjforage.__file__}}"
for found in pkgutil.walk_packages(mjforage.__path__, "mjforage."):
    if not found.name.endswith(".__main__"):
        try:
            importlib.import_module(found.name)
        except ModuleNotFoundError as error:
            if (error.name or "").partition(".")[0] not in {EXTRAS}:
                raise
environment = gymnasium.make("mjforage/Foraging-v0", scenario="comb-port")
environment.reset(seed=1)
environment.step(environment.action_space.sample())
facts = importlib.metadata.metadata("mjforage")
assert facts["License-Expression"] == "Apache-2.0", facts["License-Expression"]
"""

EDITABLE = f"""
import mjforage.metrics, mjforage.controllers, mjforage.graph_planner
assert mjforage.__file__ == {os.fspath(REPOSITORY / "mjforage/__init__.py")!r}, mjforage.__file__
"""


class FailedError(RuntimeError):
    """A command that did not end well, with what it said."""


def run(command: Sequence[str], folder: Path) -> None:
    """Run a command in a folder, without the variables of this process that are about Python.

    Raises
    ------
    FailedError
        If its exit code is not 0, with the last lines of what it said.
    """
    env = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "VIRTUAL_ENV"))}
    done = subprocess.run(
        command, cwd=folder, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    if done.returncode:
        said = "\n".join(done.stdout.splitlines()[-25:])
        raise FailedError(f"{' '.join(command)}: exit code {done.returncode}\n{said}")


def sharing(place: Path) -> Path:
    """Make an environment that finds the libraries of this one, but not this checkout or extras.

    The path files of a folder that a path file adds are not read: an editable install of the
    checkout, which is such a file, does not come with the libraries.
    """
    venv.create(place, with_pip=True)
    inside = {"base": str(place), "platbase": str(place)}
    packages = Path(sysconfig.get_path("purelib", "venv", inside))
    (packages / "without_extras.py").write_text(WITHOUT)
    lines = f"{sysconfig.get_path('purelib')}\nimport without_extras\n"
    (packages / "libraries.pth").write_text(lines)
    return place / "bin"


def among_users_own(folder: Path) -> Path:
    """Make a folder of a user, with modules by the names of ours."""
    for name in USERS_OWN:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(f"raise SystemExit('{name} of the user is imported')\n")
    return folder


def use(place: Path, folder: Path, commands: Sequence[str]) -> None:
    """Run commands of an environment in a folder; raises as `run`."""
    for command in commands:
        sys.stdout.write(f"dist: {command}\n")
        sys.stdout.flush()
        name, *words = command.split()
        run([f"{place}/{name}", *words], folder)


def try_wheel(wheel: Path, folder: Path, python: str | None) -> None:
    """Install a wheel and use it in a folder that has modules by the names of ours.

    Parameters
    ----------
    folder : an empty folder outside of the checkout
    python : an interpreter, to install all dependencies from the index as well, within
        constraints.txt; none to share those of the environment that runs this

    Raises
    ------
    FailedError
        If a command fails, or something that it should have made is not there.
    """
    if python:
        run([python, "-m", "venv", os.fspath(folder / "environment")], REPOSITORY)
        place = folder / "environment" / "bin"
        how = ["-c", os.fspath(REPOSITORY / "constraints.txt")]
    else:
        place, how = sharing(folder / "environment"), ["--no-deps"]
    run([f"{place}/python", "-m", "pip", "install", "--quiet", *how, os.fspath(wheel)], folder)
    work = among_users_own(folder / "work")
    (work / "all_modules.py").write_text(ALL_MODULES)
    use(place, work, USES)
    if missing := [name for name in MADE if not (work / name).is_file()]:
        raise FailedError(f"made no {', '.join(missing)}")


def try_editable(folder: Path) -> None:
    """Install the checkout as editable, and import it in a folder of a user; raises as `run`."""
    place = sharing(folder / "editable")
    pip = [f"{place}/python", "-m", "pip", "install", "--quiet", "--no-deps", "--editable"]
    run([*pip, os.fspath(REPOSITORY)], folder)
    work = among_users_own(folder / "editable-work")
    (work / "imports.py").write_text(EDITABLE)
    use(place, work, ["python imports.py", "mjforage policies"])
