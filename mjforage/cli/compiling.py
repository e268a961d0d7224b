"""`mjforage compile`."""

from mjforage.cli.console import app, output
from mjforage.cli.flags import Policies, Words


@app.command(name="compile")
def compile_kernels(
    *scenarios: str,
    policy: Policies = (),
    world: Words = (),
) -> None:
    """Compile what missions and environments need, before they are first used.

    Without it the first run or reset compiles, which takes up to a minute. For images of
    containers, and before the workers of a cluster start. The results lie in the user's cache, or
    in the folder of the environment variable NUMBA_CACHE_DIR, and are for this type of processor.

    Parameters
    ----------
    scenarios
        Shipped scenarios or TOML files; default comb-port, comb-port-weather and comb-port-radio.
    policy
        May be given several times; default greedy and belief.
    world
        May be given several times; default graph and physics.
    """
    from mjforage.api.compiling import compile_kernels
    from mjforage.base.kernel_cache import kernel_folder
    from mjforage.cli.progress import working

    with working("compile"):
        compile_kernels(scenarios, policy, world)
    folder = kernel_folder()
    count = len(list(folder.glob("*.nbc"))) if folder is not None else 0
    output.print(f"{folder}: {count} kernels", soft_wrap=True)
