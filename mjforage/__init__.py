"""mjforage: cooperative foraging by autonomous surface vehicles, one mission in two worlds."""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mjforage.learning.environments.parallel import ForagingParallelEnv

    __version__: str
# This process is the command `mjforage`, or `python -m mjforage`.
_is_module = ("-m", "mjforage") in zip(sys.orig_argv, sys.orig_argv[1:], strict=False)
if _is_module or Path(sys.argv[0]).stem == "mjforage":
    from mjforage.base.interrupted import end_on_ctrl_c

    if not _is_module:
        os.environ["PYTHONSAFEPATH"] = "1"  # nor do workers import from the present folder
    end_on_ctrl_c()  # before the rest is imported, which takes a fifth of a second


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
