"""mjforage: cooperative foraging by autonomous surface vehicles, one mission in two worlds."""

import importlib.util
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mjforage.learning.environments.parallel import ForagingParallelEnv

    __version__: str
_FLOORS = ("metrics", "controllers", "graph_planner")


def _check_floors() -> None:
    """Say so if another module of a common name hides one of ours."""
    home = Path(__file__).resolve().parent.parent
    for name in _FLOORS:
        spec = importlib.util.find_spec(name)
        found = Path(spec.origin).resolve() if spec and spec.origin else None
        ours = home / name / "__init__.py"
        if found != ours:
            raise ImportError(
                f"mjforage needs its own package {name!r} at {ours}, but Python finds "
                f"{found or 'none'}; rename that module or take its folder off the Python path"
            )


# This process is the command `mjforage`, or `python -m mjforage`.
_is_module = ("-m", "mjforage") in zip(sys.orig_argv, sys.orig_argv[1:], strict=False)
if _is_module or Path(sys.argv[0]).stem == "mjforage":
    from mjforage.base.interrupted import end_on_ctrl_c

    if not _is_module:
        os.environ["PYTHONSAFEPATH"] = "1"  # nor do workers import from the present folder
    end_on_ctrl_c()  # before the rest is imported, which takes a fifth of a second
_check_floors()


def __getattr__(name: str) -> str:
    """`__version__`, which takes a while to find out."""
    if name != "__version__":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib.metadata import version

    return version("mjforage")


def parallel_env(**options: Any) -> "ForagingParallelEnv":
    """The PettingZoo view of a mission.

    Parameters
    ----------
    options : scenario, world, observation, reward, map, set, render_mode; see
        `mjforage.learning.environments.options.EnvironmentOptions`

    Raises
    ------
    UserError
        If one is not valid.
    """
    from mjforage.learning.environments.parallel import ForagingParallelEnv

    return ForagingParallelEnv(**options)


def _register() -> None:
    from mjforage.learning.environments.registration import register_all

    register_all()


_register()
