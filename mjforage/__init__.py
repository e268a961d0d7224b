"""mjforage: cooperative foraging by autonomous surface vehicles, one mission in two worlds.

Everything here is documented in docs/python.md, and imported when it is first used.
"""

import os
import sys
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mjforage.api.evaluating import compare, evaluate, load_run
    from mjforage.api.maps import Map
    from mjforage.api.missions import Mission, State, make_mission
    from mjforage.api.names import names
    from mjforage.api.run import Run
    from mjforage.api.scenarios import Scenario, load_scenario
    from mjforage.api.studies import Study, board, study
    from mjforage.api.training import train
    from mjforage.api.view import View
    from mjforage.base.errors import UserError
    from mjforage.learning.environments.parallel import ForagingParallelEnv
    from mjforage.physics.vessels import Vessel, load_vessel

    __version__: str
# This process is the command `mjforage`, or `python -m mjforage`.
_is_module = ("-m", "mjforage") in zip(sys.orig_argv, sys.orig_argv[1:], strict=False)
if _is_module or Path(sys.argv[0]).stem == "mjforage":
    from mjforage.base.interrupted import end_on_ctrl_c

    if not _is_module:
        os.environ["PYTHONSAFEPATH"] = "1"  # nor do workers import from the present folder
    end_on_ctrl_c()  # before the rest is imported, which takes a fifth of a second

_PLACES = {
    "Map": "api.maps",
    "Mission": "api.missions",
    "Run": "api.run",
    "Scenario": "api.scenarios",
    "State": "api.missions",
    "UserError": "base.errors",
    "Vessel": "physics.vessels",
    "Study": "api.studies",
    "View": "api.view",
    "board": "api.studies",
    "compare": "api.evaluating",
    "evaluate": "api.evaluating",
    "load_run": "api.evaluating",
    "load_scenario": "api.scenarios",
    "load_vessel": "physics.vessels",
    "make_mission": "api.missions",
    "names": "api.names",
    "study": "api.studies",
    "train": "api.training",
}
"""Public name -> module that has it."""

__all__ = [
    "Map",
    "Mission",
    "Run",
    "Scenario",
    "State",
    "Study",
    "UserError",
    "Vessel",
    "View",
    "board",
    "compare",
    "evaluate",
    "load_run",
    "load_scenario",
    "load_vessel",
    "make_mission",
    "names",
    "parallel_env",
    "study",
    "train",
]


def __getattr__(name: str) -> Any:
    """A public name, imported when it is first used; and `__version__`."""
    if name in _PLACES:
        found = getattr(import_module(f"mjforage.{_PLACES[name]}"), name)
        globals()[name] = found
        return found
    if name != "__version__":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib.metadata import version

    return version("mjforage")


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


def parallel_env(
    scenario: Any = "comb-port",
    *,
    world: str = "graph",
    observation: str = "egocentric",
    reward: Any = "mission",
    map: Any = None,
    set: Any = (),
    render_mode: str | None = None,
    dtype: str = "float32",
) -> "ForagingParallelEnv":
    """The PettingZoo view of a mission.

    Parameters
    ----------
    scenario : of `load_scenario`, a shipped name, or a TOML file
    world : one of `mf.names("worlds")`
    observation : one of `mf.names("observations")`, or ``package.module:Class``
    reward : "mission", "published", "ddqn", or weights by term, see docs/howto/reward.md
    map : another grid: a name, a file, or an array (rows, columns), True for water
    set : changed keys, such as ``{"horizon": 60}`` or ``["horizon=60"]``
    render_mode : "rgb_array", or None: no pictures
    dtype : of the observations: "float32", or "uint8", levels of which 255 is 1

    Raises
    ------
    UserError
        If one is not valid.

    Examples
    --------
    >>> import mjforage as mf
    >>> mf.parallel_env(scenario="open-bay").possible_agents
    ['scouts_0', 'scouts_1', 'foragers_0', 'foragers_1']
    """
    from mjforage.learning.environments.parallel import ForagingParallelEnv

    return ForagingParallelEnv(
        scenario=scenario,
        world=world,
        observation=observation,
        reward=reward,
        map=map,
        set=set,
        render_mode=render_mode,
        dtype=dtype,
    )


def _begin() -> None:
    import logging

    from mjforage.learning.environments.registration import register_all

    register_all()
    logging.getLogger(__name__).addHandler(logging.NullHandler())  # else Python prints warnings


_begin()
