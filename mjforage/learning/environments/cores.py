"""Sub-environments on the host, or on the device of their hulls."""

from mjforage.learning.environments.core import EnvironmentCore
from mjforage.learning.environments.options import EnvironmentOptions


def create_core(
    options: EnvironmentOptions, num_envs: int = 1, threads: int = 1
) -> EnvironmentCore:
    """Sub-environments, on the device of their hulls if all of them can be there."""
    if options.setup.scenario.physics.device != "cpu" and options.world != "graph":
        from mjforage.learning.environments.device_core import DeviceCore

        core = DeviceCore(options, num_envs, threads=threads)
        if core.fits:
            return core
    return EnvironmentCore(options, num_envs, threads=threads)
