"""Sub-environments on the host, or on the device of their hulls."""

from mjforage.base.cached import warn_once
from mjforage.learning.environments.core import EnvironmentCore
from mjforage.learning.environments.options import EnvironmentOptions


def create_core(
    options: EnvironmentOptions, num_envs: int = 1, threads: int = 1
) -> EnvironmentCore:
    """Sub-environments, on the device of their hulls if all of them can be there.

    Otherwise a line tells what keeps sensing, knowledge and observations on this processor.
    """
    device = options.setup.scenario.physics.device
    if device != "cpu" and options.world != "graph":
        from mjforage.learning.environments.device_core import DeviceCore

        core = DeviceCore(options, num_envs, threads=threads)
        if not core.lacking:
            return core
        warn_once(
            f"device {device}: has no kernels for {core.lacking}; hulls move there, and this "
            "processor does the rest of a decision"
        )
    return EnvironmentCore(options, num_envs, threads=threads)
