"""Sub-environments on the host, or on the device of their hulls; of one map, or of several."""

from collections.abc import Callable, Sequence

import numpy as np

from mjforage.base.cached import warn_once
from mjforage.base.errors import UserError
from mjforage.graph_planner.encodings import Shapes, create_encoder
from mjforage.learning.environments.core import EnvironmentCore
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.environments.several_cores import SeveralCores


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


def create_cores(
    create: Callable[..., EnvironmentCore],
    options: Sequence[EnvironmentOptions],
    num_envs: int,
    threads: int = 1,
) -> EnvironmentCore | SeveralCores:
    """Sub-environments, number i with the options i modulo their number.

    Raises `UserError` if fleets or arrays of what agents see differ, or this machine has not the
    memory for all of them on the largest map.

    Parameters
    ----------
    create : `create_core`, or `EnvironmentCore`
    options : of one map each, at most `num_envs`
    threads : of each core, see `create_mission`
    """
    if len(options) == 1:
        return create(options[0], num_envs, threads=threads)
    common_shapes(options)
    largest = max((each.setup for each in options), key=lambda setup: len(setup.graph))
    largest.check_memory(num_envs)
    envs = [np.arange(first, num_envs, len(options)) for first in range(len(options))]
    cores = [
        create(each, own.size, threads=min(threads, own.size))
        for each, own in zip(options, envs, strict=True)
    ]
    return SeveralCores(cores, envs)


def common_shapes(every: Sequence[EnvironmentOptions]) -> Shapes:
    """Shapes of the pictures of all that is played.

    Raises `UserError` if they cannot share networks and replays.
    """
    found = [
        (
            each.setup.fleet.collects.tolist(),
            create_encoder(each.observation, each.setup.task).shapes,
        )
        for each in every
    ]
    for options, other in zip(every, found, strict=True):
        if other != found[0]:
            first, one = (
                f"{each.setup.scenario.name} on map {each.setup.grid.name}"
                for each in (every[0], options)
            )
            raise UserError(
                f"scenarios {first} and {one}: fleets or arrays of observation = "
                f"{options.observation!r} differ; give scenarios with as many scouts and foragers, "
                "on the egocentric observation"
            )
    return found[0][1]
